/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A short list, oldest first. */
#include "net/paint/held.h"

#include <string.h>

bool held_push(struct held *held, struct batch *batch)
{
    if (held->count == HELD)
        return false;
    struct batch empty = held->batches[held->count];
    held->batches[held->count++] = *batch;
    *batch = empty;
    batch->count = 0;
    return true;
}

void held_pop(struct held *held, struct batch *batch)
{
    struct batch empty = *batch;
    *batch = held->batches[0];
    memmove(held->batches, held->batches + 1, --held->count * sizeof(*batch));
    empty.count = 0;
    held->batches[held->count] = empty;
}

bool held_due(struct held *held, bool others)
{
    bool due = held->count > 0 && (held->due || !others);
    held->due = !due;
    return due;
}

void held_finish(struct held *held)
{
    for (size_t i = 0; i < HELD; i++)
        batch_finish(&held->batches[i]);
}
