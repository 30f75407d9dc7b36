/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Awaited frames: frames completely submitted to the GPU whose pixels are not read back yet, oldest first. The next frame can be drawn
   meanwhile. Thread: the render thread. */
#ifndef SERVICE_AWAITED_FRAMES_H
#define SERVICE_AWAITED_FRAMES_H
#include "render/split_view.h"
#include "service/request_group.h"
#include "value/snapshot_cache.h"
#include "value/store.h"

enum { AWAITED_FRAMES_MOST = 3 };

struct awaited_frames {
    struct awaited_frame {
        struct split_view *split;
        struct request_group group; /* the requests that this frame answers */
        /* reference to the readings of a past instant; NULL: the readings are in `snapshot` */
        const struct historical_snapshot *historical;
        struct snapshot *snapshot;
        uint64_t content; /* hash of the content that the frame shows */
    } at[AWAITED_FRAMES_MOST];
    int count;
};

/* Allocates the memory of the list's snapshots, each with tag_count readings. */
void awaited_frames_init(struct awaited_frames *in_flight, size_t tag_count);
/* Frees the memory of the list's snapshots; no frame may be in the list. */
void awaited_frames_finish(struct awaited_frames *in_flight);
/* Adds a frame; the list must not be full. Takes over the frame's split view, historical snapshot and group; without a historical snapshot
   also *snapshot. Afterwards *group is empty, and *snapshot is a different one with unspecified content. */
void awaited_frames_push(struct awaited_frames *in_flight, const struct awaited_frame *frame, struct request_group *group,
                         struct snapshot **snapshot);
/* Returns the frame in the list with that content hash; NULL: none. Frames that get an overlay are skipped. The frame stays in the list and
   is valid until the next awaited_frames_pop(). */
struct awaited_frame *awaited_frames_find(struct awaited_frames *in_flight, uint64_t content);
/* Returns the readings that the frame shows. */
const struct snapshot *awaited_frames_readings(const struct awaited_frame *frame);
/* Removes the oldest frame, which must have been read back and whose historical snapshot must have been released. Its memory is reused
   for the next frame. */
void awaited_frames_pop(struct awaited_frames *in_flight);

#endif
