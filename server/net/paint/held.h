/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures that cannot be drawn yet, each waiting for its next turn. Pure. */
#ifndef NET_HELD_H
#define NET_HELD_H
#include "net/paint/batch.h"

enum { HELD = 16 };
struct held { /* zero-initialise */
    struct batch batches[HELD]; /* the oldest first; what is behind them is empty, with memory to use again */
    size_t count;
    bool due; /* before the next of the others */
};

/* Takes what is in the batch, and leaves an empty one. False: no room, and nothing happened. */
bool held_push(struct held *held, struct batch *batch);
void held_pop(struct held *held, struct batch *batch); /* the oldest, in place of what was in batch; there is one */
/* It is the turn of one of them: of every second picture while others have anything to do. */
bool held_due(struct held *held, bool others);
void held_finish(struct held *held);

#endif
