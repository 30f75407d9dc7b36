/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Frames come and go. */
#include "render/frame.h"

#include <stdatomic.h>

#include "base/mem.h"
#include "value/quality.h"

struct frame *frame_create(int width_px, int height_px)
{
    struct frame *frame = mem_new(sizeof(*frame));
    atomic_init(&frame->refs, 1);
    frame->width_px = width_px;
    frame->height_px = height_px;
    frame->stride_bytes = width_px * 4;
    frame->bgrx = mem_try_array((size_t)height_px, (size_t)frame->stride_bytes);
    if (!frame->bgrx)
        frame_unref(&frame);
    return frame;
}

struct frame *frame_ref(struct frame *frame)
{
    atomic_fetch_add_explicit(&frame->refs, 1, memory_order_relaxed);
    return frame;
}

void frame_unref(struct frame **frame_ptr)
{
    struct frame *frame = *frame_ptr;
    *frame_ptr = NULL;
    if (!frame || atomic_fetch_sub_explicit(&frame->refs, 1, memory_order_acq_rel) != 1)
        return;
    mem_free(frame->markers);
    mem_free(frame->labels);
    mem_free(frame->bgrx);
    mem_free(frame);
}

void frame_read_markers(struct frame *frame, const struct snapshot *snapshot)
{
    size_t kept = 0;
    for (size_t i = 0; i < frame->marker_count; i++) {
        if (frame->markers[i].x_px <= FRAME_BEHIND_PX)
            continue;
        frame->markers[kept] = frame->markers[i];
        struct frame_marker *marker = &frame->markers[kept++];
        const struct reading *reading = &snapshot->readings[marker->tag];
        marker->quality = reading->quality;
        marker->value = quality_is_bad(reading->quality) ? 0 : reading->value;
    }
    frame->marker_count = kept;
}
