/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures that cannot be drawn yet, each waiting for its next turn. Pure. */
#ifndef SERVICE_DEFERRED_REQUESTS_H
#define SERVICE_DEFERRED_REQUESTS_H
#include "service/request_group.h"

enum { HELD = 16 };
struct deferred_requests {              /* zero-initialise */
    struct request_group batches[HELD]; /* the oldest first; what is behind them is empty, with memory to use again */
    size_t count;
    bool due; /* before the next of the others */
};

/* Takes what is in the batch, and leaves an empty one. False: no room, and nothing happened. */
bool deferred_requests_push(struct deferred_requests *held, struct request_group *batch);
void deferred_requests_pop(struct deferred_requests *held,
                           struct request_group *batch); /* the oldest, in place of what was in batch; there is one */
/* It is the turn of one of them: of every second picture while others have anything to do. */
bool deferred_requests_due(struct deferred_requests *held, bool others);
void deferred_requests_finish(struct deferred_requests *held);

#endif
