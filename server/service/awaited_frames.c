/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Implements the queue of frames that were submitted to the GPU and not read back yet. */
#include "service/awaited_frames.h"

#include <string.h>

void awaited_frames_init(struct awaited_frames *in_flight, size_t tag_count)
{
    for (int i = 0; i < AWAITED_FRAMES_MOST; i++)
        in_flight->at[i].snapshot = snapshot_create(tag_count);
}

void awaited_frames_finish(struct awaited_frames *in_flight)
{
    for (int i = 0; i < AWAITED_FRAMES_MOST; i++) {
        request_group_finish(&in_flight->at[i].group);
        snapshot_destroy(&in_flight->at[i].snapshot);
    }
}

void awaited_frames_push(struct awaited_frames *in_flight, const struct awaited_frame *flight, struct request_group *group,
                         struct snapshot **snapshot)
{
    struct awaited_frame *last = &in_flight->at[in_flight->count++], spare = *last;
    *last = *flight;
    last->group = *group;
    last->snapshot = flight->historical ? spare.snapshot : *snapshot;
    *group = spare.group;
    group->count = 0;
    if (!flight->historical)
        *snapshot = spare.snapshot;
}

const struct snapshot *awaited_frames_readings(const struct awaited_frame *flight)
{
    return flight->historical ? &flight->historical->snapshot : flight->snapshot;
}

struct awaited_frame *awaited_frames_find(struct awaited_frames *in_flight, uint64_t content)
{
    for (int i = 0; i < in_flight->count; i++)
        if (in_flight->at[i].content == content && !in_flight->at[i].group.tickets[0].request.overlay)
            return &in_flight->at[i];
    return NULL;
}

void awaited_frames_pop(struct awaited_frames *in_flight)
{
    struct awaited_frame first = in_flight->at[0];
    in_flight->count--;
    memmove(&in_flight->at[0], &in_flight->at[1], (AWAITED_FRAMES_MOST - 1) * sizeof(first));
    first.split = NULL;
    first.group.count = 0;
    in_flight->at[AWAITED_FRAMES_MOST - 1] = first;
}
