/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A short list, oldest first. */
#include "service/deferred_requests.h"

#include <string.h>

bool deferred_requests_push(struct deferred_requests *held, struct request_group *batch)
{
    if (held->count == HELD)
        return false;
    struct request_group empty = held->batches[held->count];
    held->batches[held->count++] = *batch;
    *batch = empty;
    batch->count = 0;
    return true;
}

void deferred_requests_pop(struct deferred_requests *held, struct request_group *batch)
{
    struct request_group empty = *batch;
    *batch = held->batches[0];
    memmove(held->batches, held->batches + 1, --held->count * sizeof(*batch));
    empty.count = 0;
    held->batches[held->count] = empty;
}

bool deferred_requests_due(struct deferred_requests *held, bool others)
{
    bool due = held->count > 0 && (held->due || !others);
    held->due = !due;
    return due;
}

void deferred_requests_finish(struct deferred_requests *held)
{
    for (size_t i = 0; i < HELD; i++)
        request_group_finish(&held->batches[i]);
}
