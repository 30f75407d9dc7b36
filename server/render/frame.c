/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Creates and releases frames, and creates frames that show part of another frame. */
#include "render/frame.h"

#include <assert.h>
#include <stdatomic.h>
#include <stddef.h>
#include <string.h>

#include "base/mem.h"
#include "render/depth_grid.h"
#include "render/frame_pool.h"
#include "render/frame_record.h"
#include "value/quality.h"

/* Maximum distance in pixels from a marker's position to any pixel of its symbol. A part of a frame includes markers up to this
   far outside it. */
static const float MARK_PX = 48;

static size_t pixel_bytes(const struct frame *frame)
{
    return (size_t)frame->height_px * (size_t)frame->stride_bytes;
}

struct frame *frame_create(struct frame_pool *pool, int width_px, int height_px)
{
    struct frame *frame = mem_new(sizeof(*frame));
    atomic_init(&frame->refs, 1);
    frame->width_px = width_px;
    frame->height_px = height_px;
    frame->stride_bytes = width_px * 4;
    frame->pool = frame_pool_ref(pool);
    frame->bgrx = frame_pool_take(pool, pixel_bytes(frame));
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
    frame_record_unref(&frame->record);
    depth_grid_unref(&frame->depth[0]);
    depth_grid_unref(&frame->depth[1]);
    if (frame->whole)
        frame_unref(&frame->whole);
    else
        frame_pool_give(frame->pool, frame->bgrx, pixel_bytes(frame));
    frame_pool_unref(&frame->pool);
    mem_free(frame);
}

/* Converts a marker's position to the coordinates of `part`, a rectangle of the frame. Returns whether any pixel of its symbol may lie in
   that part: a symbol on the border between two parts is drawn in both. */
static bool is_near(const struct frame_part *part, float *x_px, float *y_px)
{
    *x_px -= (float)part->x_px;
    *y_px -= (float)part->y_px;
    return *x_px > -MARK_PX && *y_px > -MARK_PX && *x_px < (float)part->width_px + MARK_PX && *y_px < (float)part->height_px + MARK_PX;
}

static uint64_t hash_part(uint64_t content, const struct frame_part *part)
{
    const int parts[] = { part->x_px, part->y_px, part->width_px, part->height_px };
    for (size_t i = 0; i < sizeof(parts) / sizeof(parts[0]); i++)
        content = (content ^ (uint64_t)parts[i]) * 0x100000001b3u; /* FNV-1a hash */
    return content;
}

struct frame *frame_cut(struct frame *whole, const struct frame_part *part)
{
    struct frame *frame = mem_new(sizeof(*frame));
    /* copies the members from `view` on; the reference count before them may be changed by other threads meanwhile */
    size_t plain = offsetof(struct frame, view);
    assert(part->x_px >= 0 && part->y_px >= 0 && part->x_px + part->width_px <= whole->width_px &&
           part->y_px + part->height_px <= whole->height_px);
    memcpy((char *)frame + plain, (const char *)whole + plain, sizeof(*frame) - plain);
    atomic_init(&frame->refs, 1);
    frame->whole = frame_ref(whole);
    frame->pool = NULL;
    frame->bgrx = whole->bgrx + (size_t)part->y_px * (size_t)whole->stride_bytes + (size_t)part->x_px * 4;
    frame->width_px = frame->view.width_px = part->width_px;
    frame->height_px = frame->view.height_px = part->height_px;
    frame->content = hash_part(whole->content, part);
    frame->record = NULL;
    frame->depth[0] = frame->depth[1] = NULL;
    frame->markers = mem_array(whole->marker_count + 1, sizeof(*frame->markers));
    frame->labels = mem_array(whole->label_count + 1, sizeof(*frame->labels));
    frame->marker_count = frame->label_count = 0;
    for (size_t i = 0; i < whole->marker_count; i++) {
        struct frame_marker marker = whole->markers[i];
        if (is_near(part, &marker.x_px, &marker.y_px))
            frame->markers[frame->marker_count++] = marker;
    }
    for (size_t i = 0; i < whole->label_count; i++) {
        struct frame_label label = whole->labels[i];
        if (is_near(part, &label.x_px, &label.y_px))
            frame->labels[frame->label_count++] = label;
    }
    return frame;
}

/* Baseline (stored earlier readings, value/baselines.h) that one half of a split view subtracts from its readings, if that half
   shows differences. */
struct then {
    /* wanted: this half shows differences from a baseline. distance: this half shows distances from a sensor; its markers
       already have these distances, which do not depend on readings */
    bool wanted, distance;
    /* the baseline's readings, which are subtracted from the view's; NULL: the baseline no longer exists */
    const struct snapshot *snapshot;
};

static struct then take_then(const struct field_params *params, struct baselines *baselines)
{
    bool wanted = params->show == SHOW_DIFFERENCE;
    return (struct then){ wanted, params->show == SHOW_DISTANCE, wanted && baselines ? baselines_take(baselines, params->baseline) : NULL };
}

static void read_marker(struct frame_marker *marker, const struct reading *now, const struct then *then)
{
    static const struct reading nothing = { .quality = QUALITY_BAD_WAITING };
    const struct reading *before = !then->wanted ? NULL : then->snapshot ? &then->snapshot->readings[marker->tag] : &nothing;
    marker->quality = before && quality_is_worse(before->quality, now->quality) ? before->quality : now->quality;
    if (!then->distance)
        marker->value = quality_is_bad(marker->quality) ? 0 : now->value - (before ? before->value : 0);
}

void frame_read_markers(struct frame *frame, const struct snapshot *snapshot, struct baselines *baselines)
{
    struct then then[2] = { take_then(&frame->view.field, baselines), { 0 } };
    size_t kept = 0;
    if (frame->view.split)
        then[1] = take_then(&frame->view.right.field, baselines);
    for (size_t i = 0; i < frame->marker_count; i++) {
        if (frame->markers[i].x_px <= FRAME_BEHIND_PX)
            continue;
        struct frame_marker *marker = &frame->markers[kept++];
        *marker = frame->markers[i];
        read_marker(marker, &snapshot->readings[marker->tag], &then[marker->half]);
    }
    frame->marker_count = kept;
    for (int half = 0; half < 2; half++)
        if (then[half].snapshot)
            baselines_give(baselines, &then[half].snapshot);
}
