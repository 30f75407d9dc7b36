/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The recent-frame cache: the last frames drawn, for clients that request the same view a moment later. So any number of
   clients of one view cost one rendering, even if their requests come at different times. Call only in the render thread. */
#ifndef SERVICE_RECENT_FRAMES_H
#define SERVICE_RECENT_FRAMES_H
#include "render/frame.h"

enum { RECENT_FRAMES = 4 };
struct recent_frames { /* zero-initialise; free with recent_frames_finish() */
    struct {
        struct frame *frame; /* reference to the cached frame; NULL: the entry is empty */
        int64_t drawn_ns;
        int64_t read_ns; /* monotonic time when the readings in the frame were taken */
    } kept[RECENT_FRAMES];
};

/* Adds a frame to the cache and drops the oldest one. Takes its own reference. */
void recent_frames_add(struct recent_frames *recent, struct frame *frame, int64_t read_ns, int64_t now_ns);
/* Returns the cached frame with that content hash if it is recent enough; the cache keeps the reference. NULL: none. */
struct frame *recent_frames_find(struct recent_frames *recent, uint64_t content, int64_t now_ns);
/* Returns a cached frame of that view whose readings were taken at read_ns or later; the cache keeps the reference. NULL: none. */
struct frame *recent_frames_find_view(struct recent_frames *recent, const struct view *view, int64_t read_ns, int64_t now_ns);
/* Empties the cache. */
void recent_frames_finish(struct recent_frames *recent);

#endif
