/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The cache of recently drawn frames: an array that is searched by the hash of what a frame shows. */
#include "service/recent_frames.h"

#include "base/clock.h"

/* maximum age of a cached frame, and thus the maximum error of the clock and of the ages of readings in the frame */
static const int64_t KEPT_NS = 500 * NS_PER_MS;
#define KEPT_BYTES ((size_t)32 * 1024 * 1024) /* limit on the bytes of all cached frames; a single frame larger than this is still kept */

static size_t bytes_of(const struct frame *frame)
{
    return frame ? (size_t)frame->stride_bytes * (size_t)frame->height_px : 0;
}

static void forget_old(struct recent_frames *recent, int64_t now_ns)
{
    for (int i = 0; i < RECENT_FRAMES; i++)
        if (recent->kept[i].frame && now_ns - recent->kept[i].drawn_ns > KEPT_NS)
            frame_unref(&recent->kept[i].frame);
}

void recent_frames_add(struct recent_frames *recent, struct frame *frame, int64_t read_ns, int64_t now_ns)
{
    size_t sum = bytes_of(frame);
    forget_old(recent, now_ns);
    frame_unref(&recent->kept[RECENT_FRAMES - 1].frame);
    for (int i = RECENT_FRAMES - 1; i > 0; i--)
        recent->kept[i] = recent->kept[i - 1];
    recent->kept[0].frame = frame_ref(frame);
    recent->kept[0].drawn_ns = now_ns;
    recent->kept[0].read_ns = read_ns;
    for (int i = 1; i < RECENT_FRAMES; i++) {
        sum += bytes_of(recent->kept[i].frame);
        if (sum > KEPT_BYTES)
            frame_unref(&recent->kept[i].frame);
    }
}

struct frame *recent_frames_find(struct recent_frames *recent, uint64_t content, int64_t now_ns)
{
    forget_old(recent, now_ns);
    for (int i = 0; i < RECENT_FRAMES; i++)
        if (recent->kept[i].frame && recent->kept[i].frame->content == content)
            return recent->kept[i].frame;
    return NULL;
}

struct frame *recent_frames_find_view(struct recent_frames *recent, const struct view *view, int64_t read_ns, int64_t now_ns)
{
    forget_old(recent, now_ns);
    for (int i = 0; i < RECENT_FRAMES; i++)
        if (recent->kept[i].frame && recent->kept[i].read_ns >= read_ns && view_equal(&recent->kept[i].frame->view, view))
            return recent->kept[i].frame;
    return NULL;
}

void recent_frames_finish(struct recent_frames *recent)
{
    for (int i = 0; i < RECENT_FRAMES; i++)
        frame_unref(&recent->kept[i].frame);
}
