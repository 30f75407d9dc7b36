/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A queue. */
#include "net/paint/flying.h"

#include <string.h>

void flying_init(struct flying *flying, size_t tag_count)
{
    for (int i = 0; i < FLYING_MOST; i++)
        flying->at[i].snapshot = snapshot_create(tag_count);
}

void flying_finish(struct flying *flying)
{
    for (int i = 0; i < FLYING_MOST; i++) {
        batch_finish(&flying->at[i].batch);
        snapshot_destroy(&flying->at[i].snapshot);
    }
}

void flying_push(struct flying *flying, const struct flying_picture *picture, struct batch *batch, struct snapshot **snapshot)
{
    struct flying_picture *last = &flying->at[flying->count++], spare = *last;
    *last = *picture;
    last->batch = *batch;
    last->snapshot = picture->moment ? spare.snapshot : *snapshot;
    *batch = spare.batch;
    batch->count = 0;
    if (!picture->moment)
        *snapshot = spare.snapshot;
}

const struct snapshot *flying_readings(const struct flying_picture *picture)
{
    return picture->moment ? &picture->moment->snapshot : picture->snapshot;
}

struct flying_picture *flying_find(struct flying *flying, uint64_t content)
{
    for (int i = 0; i < flying->count; i++)
        if (flying->at[i].content == content && !flying->at[i].batch.orders[0].wish.overlay)
            return &flying->at[i];
    return NULL;
}

void flying_pop(struct flying *flying)
{
    struct flying_picture first = flying->at[0];
    flying->count--;
    memmove(&flying->at[0], &flying->at[1], (FLYING_MOST - 1) * sizeof(first));
    first.canvas = NULL;
    first.batch.count = 0;
    flying->at[FLYING_MOST - 1] = first;
}
