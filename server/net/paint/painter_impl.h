/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the two halves of the painter share: wishes (painter.c, any thread) and drawing (drawing.c, the render thread). Private to them. */
#ifndef NET_PAINTER_IMPL_H
#define NET_PAINTER_IMPL_H
#include <pthread.h>

#include "net/paint/encoding.h"
#include "net/paint/painter.h"
#include "net/paint/payers.h"

struct client {
    uint64_t id, number;
    bool pending, has_content;
    bool left; /* the slow picture: it wants another by now */
    struct wish wish;
    uint64_t content; /* of the last picture drawn for it */
    int64_t spent_ns[SCHEDULE_SHARES]; /* of drawing time, its share; see schedule.h */
    struct payer *payer; /* of its wish */
};

struct painter {
    struct painter_params params;
    counter *renders, *render_us, *same, *shared, *failures, *steps, *abandoned, *losses, *picked, *pick_us;
    struct picks *picks;
    struct encoding *encoding;
    pthread_t thread;
    bool has_thread;
    pthread_mutex_t lock;
    pthread_cond_t wake;
    /* --- below: under lock */
    enum { STARTING, RUNNING, FAILED, STOPPING } state;
    bool new_data;
    const struct proofs *proofs; /* NULL: nothing is unproven */
    bool lost, lose; /* the GL context; at the next picture */
    struct client **clients; /* by id, ascending */
    size_t client_count, client_capacity;
    struct payers payers;
    int64_t spent_ns[SCHEDULE_SHARES]; /* what the client that was served last had spent before */
    struct picture *done, **done_last;
    bool announced; /* somebody was told of them */
};

/* Under lock. NULL: none. */
struct client *painter_find(struct painter *painter, uint64_t id);
/* Answers every order of the batch: there is nothing new to be seen, or there is no picture. */
void painter_post_none(struct painter *painter, const struct batch *batch, bool failed);
/* The render thread, from making the GL context to its end. arg: struct painter. */
void *drawing_main(void *arg);

#endif
