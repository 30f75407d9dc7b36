/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State that the render thread shares with the threads that call the render service. Private to this folder. */
#ifndef SERVICE_RENDER_SERVICE_IMPL_H
#define SERVICE_RENDER_SERVICE_IMPL_H
#include <pthread.h>

#include "service/encode_queue.h"
#include "service/render_service.h"
#include "service/time_accounts.h"

struct render_client {
    uint64_t id, number; /* id: id of the client; number: sequence number of the client's newest request whose drawing has begun */
    bool pending;        /* true: the drawing of `request` has not begun yet */
    bool has_content;
    bool has_depth; /* true: the client has the depth grid that belongs to the content last sent to it */
    bool left; /* true: the client has withdrawn and no longer wants the frame that the long job (a frame drawn in steps) draws for it */
    /* how long changed readings wait for this client's long job (a frame drawn in steps) before the client gets a preview with
       these readings; 0: the initial time */
    int64_t patience_ns;
    struct frame_request request;
    /* content: hash of what the newest frame for the client shows; content_number: sequence number of the request answered by this frame */
    uint64_t content, content_number;
    int64_t spent_ns[SCHEDULER_SHARES]; /* drawing time charged to the client, indexed by kind of frame (scheduler_share()) */
    /* time account of the client's address, to which the drawing time for all its clients is charged */
    struct time_account *account;
};

struct render_service {
    struct render_service_params params;
    counter *renders, *render_us, *same, *shared, *failures, *steps, *abandoned, *losses, *picked, *pick_us;
    struct pick_queue *picks;
    struct encode_queue *queue;
    pthread_t thread;
    bool has_thread;
    pthread_mutex_t lock;
    pthread_cond_t wake;
    /* --- below: protected by `lock` */
    enum { STARTING, RUNNING, FAILED, STOPPING } state;
    bool has_news;                         /* true: requests were queued since the render thread was last woken */
    struct snapshot *readings;             /* copy of the event loop's newest snapshot of readings */
    const struct loop_checks *loop_checks; /* loop check records; NULL: no tag is marked as unchecked */
    bool lost;                             /* true: the GL context is lost and being rebuilt */
    int64_t asked_ns; /* monotonic time since which a check has waited for the render thread's answer; 0: none waits */
    bool lose;        /* true: a test wants the GL context destroyed in the middle of the next frame */
    struct render_client **clients;        /* clients of the service, sorted by id */
    size_t client_count, client_capacity;
    struct time_accounts accounts;
    /* by kind of frame (scheduler_share()): drawing time charged to the client served last, as of before it was served; clients
       that enter the queue start with at least this charge */
    int64_t spent_ns[SCHEDULER_SHARES];
    struct encoded_frame *done, **done_last; /* encoded frames that the event loop has not collected yet, oldest first */
    bool announced;                          /* true: params.notify was called, and the event loop has not collected the frames since */
};

/* --- render_clients.c ------------------------------------------------------------------------------------------------- */

/* Returns the client with that id, or NULL. The caller holds the lock. */
struct render_client *render_service_find(struct render_service *service, uint64_t id);
/* Adds a client; the id must be new. account: id of its time account. The caller holds the lock. */
struct render_client *render_service_add_client(struct render_service *service, uint64_t id, uint64_t account);
/* Removes the client, if it exists. The caller holds the lock. */
void render_service_remove_client(struct render_service *service, uint64_t id);

/* --- render_answers.c ------------------------------------------------------------------------------------------------- */

/* Answers each request of the group without a frame; `absence` says why. Any thread. */
void render_service_answer_without_frame(struct render_service *service, const struct request_group *group, enum frame_absence absence);
/* Calls params.notify if encoded frames or pick answers wait for collection and notify was not yet called for them. Any thread. */
void render_service_announce(void *service);
/* Takes the encoded packets for one request (ticket), or the failure, from the encode queue. Called in a worker thread. */
void render_service_on_encoded(void *service, const struct request_ticket *ticket, struct packet *const *packets, int count, bool failed);

/* --- render_thread.c -------------------------------------------------------------------------------------------------- */

/* The render thread's main function, from creating the GL context to its end. arg: the service. */
void *render_thread_main(void *arg);

#endif
