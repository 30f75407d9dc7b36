/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A queue. */
#include "service/awaited_frames.h"

#include <string.h>

void awaited_frames_init(struct awaited_frames *flying, size_t tag_count)
{
    for (int i = 0; i < AWAITED_FRAMES_MOST; i++)
        flying->at[i].snapshot = snapshot_create(tag_count);
}

void awaited_frames_finish(struct awaited_frames *flying)
{
    for (int i = 0; i < AWAITED_FRAMES_MOST; i++) {
        request_group_finish(&flying->at[i].batch);
        snapshot_destroy(&flying->at[i].snapshot);
    }
}

void awaited_frames_push(struct awaited_frames *flying, const struct awaited_frame *picture, struct request_group *batch,
                         struct snapshot **snapshot)
{
    struct awaited_frame *last = &flying->at[flying->count++], spare = *last;
    *last = *picture;
    last->batch = *batch;
    last->snapshot = picture->historical ? spare.snapshot : *snapshot;
    *batch = spare.batch;
    batch->count = 0;
    if (!picture->historical)
        *snapshot = spare.snapshot;
}

const struct snapshot *awaited_frames_readings(const struct awaited_frame *picture)
{
    return picture->historical ? &picture->historical->snapshot : picture->snapshot;
}

struct awaited_frame *awaited_frames_find(struct awaited_frames *flying, uint64_t content)
{
    for (int i = 0; i < flying->count; i++)
        if (flying->at[i].content == content && !flying->at[i].batch.orders[0].wish.overlay)
            return &flying->at[i];
    return NULL;
}

void awaited_frames_pop(struct awaited_frames *flying)
{
    struct awaited_frame first = flying->at[0];
    flying->count--;
    memmove(&flying->at[0], &flying->at[1], (AWAITED_FRAMES_MOST - 1) * sizeof(first));
    first.split = NULL;
    first.batch.count = 0;
    flying->at[AWAITED_FRAMES_MOST - 1] = first;
}
