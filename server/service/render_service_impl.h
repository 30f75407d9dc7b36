/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the two halves of the painter share: wishes (painter.c, any thread) and drawing (drawing.c, the render thread). Private to them. */
#ifndef SERVICE_RENDER_SERVICE_IMPL_H
#define SERVICE_RENDER_SERVICE_IMPL_H
#include <pthread.h>

#include "service/encode_queue.h"
#include "service/render_service.h"
#include "service/time_accounts.h"

struct render_client {
    uint64_t id, number;
    bool pending, has_content;
    bool left; /* the slow picture: it wants another by now */
    struct frame_request wish;
    uint64_t content;                   /* of the last picture drawn for it */
    int64_t spent_ns[SCHEDULER_SHARES]; /* of drawing time, its share; see schedule.h */
    struct time_account *payer;         /* of its wish */
};

struct render_service {
    struct render_service_params params;
    counter *renders, *render_us, *same, *shared, *failures, *steps, *abandoned, *losses, *picked, *pick_us;
    struct pick_queue *picks;
    struct encode_queue *encoding;
    pthread_t thread;
    bool has_thread;
    pthread_mutex_t lock;
    pthread_cond_t wake;
    /* --- below: under lock */
    enum { STARTING, RUNNING, FAILED, STOPPING } state;
    bool new_data;
    const struct loop_checks *loop_checks; /* NULL: nothing is unproven */
    bool lost, lose;                       /* the GL context; at the next picture */
    struct render_client **clients;        /* by id, ascending */
    size_t client_count, client_capacity;
    struct time_accounts payers;
    int64_t spent_ns[SCHEDULER_SHARES]; /* what the client that was served last had spent before */
    struct encoded_frame *done, **done_last;
    bool announced; /* somebody was told of them */
};

/* Under lock. NULL: none. */
struct render_client *render_service_find(struct render_service *painter, uint64_t id);
/* Answers every order of the batch: there is nothing new to be seen, or there is no picture. */
void render_service_answer_without_frame(struct render_service *painter, const struct request_group *batch, bool failed);
/* The render thread, from making the GL context to its end. arg: struct render_service. */
void *render_thread_main(void *arg);

#endif
