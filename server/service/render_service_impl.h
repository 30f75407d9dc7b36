/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The state that callers of the render service and the render thread share. Private to this folder. */
#ifndef SERVICE_RENDER_SERVICE_IMPL_H
#define SERVICE_RENDER_SERVICE_IMPL_H
#include <pthread.h>

#include "service/encode_queue.h"
#include "service/render_service.h"
#include "service/time_accounts.h"

struct render_client {
    uint64_t id, number; /* number counts its requests as drawing of them begins */
    bool pending;        /* `request` has yet to be begun */
    bool has_content;
    bool left; /* it wants another frame than the long job that is drawn for it */
    int64_t patience_ns; /* so long changed readings wait for a long job of it; 0: as at first */
    struct frame_request request;
    uint64_t content, content_number;   /* content hash of the newest frame drawn for it, and that frame's number */
    int64_t spent_ns[SCHEDULER_SHARES]; /* drawing time that it was charged, by scheduler_share */
    struct time_account *account;       /* of its address */
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
    /* --- below: under lock */
    enum { STARTING, RUNNING, FAILED, STOPPING } state;
    bool has_news;                         /* requests came since the render thread was last woken for them */
    bool new_data;                         /* readings changed since the last snapshot */
    const struct loop_checks *loop_checks; /* NULL: no tag is marked as unchecked */
    bool lost;                             /* the GL context is being made anew */
    int64_t asked_ns;                      /* since when a sign of life is waited for; 0: there was one */
    bool lose;                             /* a test wants it lost in the middle of the next frame */
    struct render_client **clients;        /* by id, ascending */
    size_t client_count, client_capacity;
    struct time_accounts accounts;
    int64_t spent_ns[SCHEDULER_SHARES];      /* what the client served last had been charged before */
    struct encoded_frame *done, **done_last; /* not collected yet, oldest first */
    bool announced;                          /* params.notify was called for them */
};

/* --- render_clients.c ------------------------------------------------------------------------------------------------- */

/* Returns the client of that id, or NULL. Under lock. */
struct render_client *render_service_find(struct render_service *service, uint64_t id);
/* Adds a client of that id, which is not there yet, with an account of that number. Under lock. */
struct render_client *render_service_add_client(struct render_service *service, uint64_t id, uint64_t account);
/* Removes the client, if it is there. Under lock. */
void render_service_remove_client(struct render_service *service, uint64_t id);

/* --- render_service.c ------------------------------------------------------------------------------------------------- */

/* Answers each request of the group without a frame: nothing new is to be seen, or drawing failed. Any thread. */
void render_service_answer_without_frame(struct render_service *service, const struct request_group *group, bool failed);

/* --- render_thread.c -------------------------------------------------------------------------------------------------- */

/* Runs the render thread, from making the GL context to its end. arg: the service. */
void *render_thread_main(void *arg);

#endif
