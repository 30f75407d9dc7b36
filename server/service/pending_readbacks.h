/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pending readbacks: frames completely submitted to the GPU whose pixels are not read back yet, oldest first. The next frame
   can be drawn meanwhile. Call only in the render thread. */
#ifndef SERVICE_PENDING_READBACKS_H
#define SERVICE_PENDING_READBACKS_H
#include "render/split_view.h"
#include "service/request_group.h"
#include "value/snapshot_cache.h"
#include "value/store.h"

enum { PENDING_READBACKS_MAX = 3 };

struct pending_readbacks {
    struct pending_readback {
        struct split_view *split;
        struct request_group group; /* requests of clients that are to be answered with this frame */
        /* reference to the readings of a past instant; NULL: the readings are in `snapshot` */
        const struct historical_snapshot *historical;
        struct snapshot *snapshot;
        uint64_t content; /* hash of what the frame shows; a request with an equal hash is answered with this frame */
        bool gives_depth; /* true: the frame has a depth grid, which is also read back from the GPU */
    } at[PENDING_READBACKS_MAX];
    int count;
};

/* Allocates the snapshots of readings in the list of frames, each with tag_count readings. */
void pending_readbacks_init(struct pending_readbacks *in_flight, size_t tag_count);
/* Frees the memory of the list's snapshots. The list must be empty. */
void pending_readbacks_finish(struct pending_readbacks *in_flight);
/* Adds a frame to the list, which must not be full. The list takes ownership of the frame's split view, its historical
 * snapshot, the requests in group and, if there is no historical snapshot, *snapshot. Afterwards *group is empty, and *snapshot
 * is a different one with unspecified content. */
void pending_readbacks_push(struct pending_readbacks *in_flight, const struct pending_readback *frame, struct request_group *group,
                            struct snapshot **snapshot);
/* Returns the submitted frame with that content hash; NULL: none. Skips frames that get an overlay and, if `depth` is true,
   frames without a depth grid. The list keeps the frame, which is valid until the next pending_readbacks_pop(). */
struct pending_readback *pending_readbacks_find(struct pending_readbacks *in_flight, uint64_t content, bool depth);
/* Returns the snapshot of readings that the frame shows. */
const struct snapshot *pending_readbacks_readings(const struct pending_readback *frame);
/* Removes the oldest frame, which must have been read back and whose historical snapshot must have been released. Its memory is reused
   for the next frame. */
void pending_readbacks_pop(struct pending_readbacks *in_flight);

#endif
