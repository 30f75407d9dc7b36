/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Awaited frames: given to the GPU whole and not read back yet, oldest first, so that the next is drawn meanwhile. Thread: the
   render thread. */
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
        struct request_group group;                   /* whose requests it answers */
        const struct historical_snapshot *historical; /* its readings, a reference; NULL: they are `snapshot` */
        struct snapshot *snapshot;
        uint64_t content; /* content hash of what it shows */
    } at[AWAITED_FRAMES_MOST];
    int count;
};

/* Allocates the snapshots, of tag_count readings each. */
void awaited_frames_init(struct awaited_frames *in_flight, size_t tag_count);
/* Frees them; no frame may be in flight. */
void awaited_frames_finish(struct awaited_frames *in_flight);
/* Adds a frame; there must be room. Takes over its split view, historical snapshot and the group, and, where there is no historical
   snapshot, *snapshot. Leaves an empty group and another snapshot, of no content, in their place. */
void awaited_frames_push(struct awaited_frames *in_flight, const struct awaited_frame *frame, struct request_group *group,
                         struct snapshot **snapshot);
/* Returns the frame of that content (a content hash), leaving out frames that get an overlay; NULL: none. It stays in the list, and valid
   until the next pop. */
struct awaited_frame *awaited_frames_find(struct awaited_frames *in_flight, uint64_t content);
/* Returns the readings that the frame shows. */
const struct snapshot *awaited_frames_readings(const struct awaited_frame *frame);
/* Removes the oldest, which has been read back and whose historical snapshot was given back. Its memory serves the next. */
void awaited_frames_pop(struct awaited_frames *in_flight);

#endif
