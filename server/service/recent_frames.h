/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The last frames that were drawn: who asks a moment later for what one of them shows needs no other. So any number of clients of one view
   cost one render, though they never ask at the same time. Thread: the render thread. */
#ifndef SERVICE_RECENT_FRAMES_H
#define SERVICE_RECENT_FRAMES_H
#include "render/frame.h"

enum { RECENT_FRAMES = 4 };
struct recent_frames { /* zero-initialise */
    struct {
        struct frame *frame;       /* NULL: none */
        int64_t drawn_ns, read_ns; /* read: when its readings were taken */
    } kept[RECENT_FRAMES];
};

void recent_frames_add(struct recent_frames *recent, struct frame *frame, int64_t read_ns, int64_t now_ns); /* takes its own reference */
struct frame *recent_frames_find(struct recent_frames *recent, uint64_t content, int64_t now_ns); /* borrowed; NULL: none of that content */
/* One of that view, with readings no older than that. */
struct frame *recent_frames_find_view(struct recent_frames *recent, const struct view *view, int64_t read_ns, int64_t now_ns);
void recent_frames_finish(struct recent_frames *recent);

#endif
