/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Queue of frames that were submitted to the GPU and not read back yet. */
#include "service/pending_readbacks.h"

#include <string.h>

void pending_readbacks_init(struct pending_readbacks *in_flight, size_t tag_count)
{
    for (int i = 0; i < PENDING_READBACKS_MAX; i++)
        in_flight->at[i].snapshot = snapshot_create(tag_count);
}

void pending_readbacks_finish(struct pending_readbacks *in_flight)
{
    for (int i = 0; i < PENDING_READBACKS_MAX; i++) {
        request_group_finish(&in_flight->at[i].group);
        snapshot_destroy(&in_flight->at[i].snapshot);
    }
}

void pending_readbacks_push(struct pending_readbacks *in_flight, const struct pending_readback *flight, struct request_group *group,
                            struct snapshot **snapshot)
{
    struct pending_readback *last = &in_flight->at[in_flight->count++], spare = *last;
    *last = *flight;
    last->group = *group;
    last->snapshot = flight->historical ? spare.snapshot : *snapshot;
    *group = spare.group;
    group->count = 0;
    if (!flight->historical)
        *snapshot = spare.snapshot;
}

const struct snapshot *pending_readbacks_readings(const struct pending_readback *flight)
{
    return flight->historical ? &flight->historical->snapshot : flight->snapshot;
}

struct pending_readback *pending_readbacks_find(struct pending_readbacks *in_flight, uint64_t content, bool depth)
{
    for (int i = 0; i < in_flight->count; i++) {
        struct pending_readback *frame = &in_flight->at[i];
        if (frame->content == content && !frame->group.tickets[0].request.overlay && (frame->gives_depth || !depth))
            return frame;
    }
    return NULL;
}

void pending_readbacks_pop(struct pending_readbacks *in_flight)
{
    struct pending_readback first = in_flight->at[0];
    in_flight->count--;
    memmove(&in_flight->at[0], &in_flight->at[1], (PENDING_READBACKS_MAX - 1) * sizeof(first));
    first.split = NULL;
    first.group.count = 0;
    in_flight->at[PENDING_READBACKS_MAX - 1] = first;
}
