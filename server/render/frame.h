/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A rendered frame: its pixels, markers and labels, and the time and baseline of the readings that it shows. Immutable once shared;
   reference-counted; may be released on any thread. */
#ifndef RENDER_FRAME_H
#define RENDER_FRAME_H
#include <stddef.h>
#include <stdint.h>

#include "render/view.h"

#define FRAME_BEHIND_PX (-1e4f) /* value of frame_marker.x_px for a marker that is behind the camera */

struct frame_marker {
    int tag;
    float x_px, y_px; /* position of the marker in pixels from the top left of the frame; may lie outside the frame */
    uint8_t occluded; /* 1: a surface hides the marker, or it lies outside the frame; 0: visible */
    uint32_t quality; /* OPC UA quality of the reading shown; for a difference the worse of the two readings */
    /* reading in engineering units, 0 if its quality is Bad. If the view shows differences: reading minus baseline; if it shows distances:
       metres, NAN if unknown */
    double value;
    /* half of a split view (two pictures side by side) that the marker is in: 0: left, or the view is not split; 1: right */
    uint8_t half;
};

struct frame_label { /* a visible point on an isoline, where the label of the isoline may be drawn; or the position of an arrow */
    double value;
    float x_px, y_px;
    /* direction of an arrow in the frame. Its length is 1 if the arrow lies in the picture plane, and less if it points towards or away
       from the viewer. 0, 0: direction unknown */
    float dx, dy;
    uint8_t half, arrow, uncertain;
    /* index of the stroke (a short streamline) within its half of the view; all points of a stroke have the same; 0: an arrow,
       not a stroke */
    uint16_t stroke;
};
/* minimum distance in pixels between the arrows of a frame; the longest arrow is almost that long */
#define FRAME_ARROW_PX(width_px) fmax(48, (width_px) / 24.0)

struct frame_part { /* a rectangle of a frame, in pixels from the top left. width_px 0: the whole frame */
    int x_px, y_px, width_px, height_px;
};

struct depth_grid; /* render/depth_grid.h */
struct frame_pool; /* render/frame_pool.h */

struct frame {
    _Atomic int refs;
    struct view view; /* the view that the frame shows */
    int width_px, height_px, stride_bytes;
    uint8_t *bgrx;                /* 4 bytes per pixel (blue, green, red, unused), rows from the top */
    /* if this frame is a part of another (frame_cut): reference to the other frame, which owns the pixels; NULL: this frame owns them */
    struct frame *whole;
    struct frame_pool *pool;      /* pool to which this frame's pixel buffer returns; NULL: the buffer does not belong to a pool */
    struct frame_marker *markers; /* sensors of the shown group */
    size_t marker_count;
    /* visible points on isolines where the isoline's value may be written (more than labels fit), and the arrows of directional fields */
    struct frame_label *labels;
    size_t label_count;
    int64_t data_utc_ns;   /* UTC time in nanoseconds of the snapshot of readings that the frame shows */
    bool clock_unset;      /* true: the clock that gave data_utc_ns was not synchronised */
    int64_t oldest_age_ns; /* age in nanoseconds of the oldest reading that the frame uses; INT64_MAX: it uses none */
    /* [half of a split view, else 0]: largest error of values in areas marked as uncertain, in the half's unit, rounded up;
       0: no area is marked */
    double drawn_error[2];
    int64_t field_ns, render_ns, readback_ns; /* duration of each stage */
    /* time that the render thread spent on this frame, waiting for the GPU included; 0: not drawn by a render thread */
    int64_t turn_ns;
    struct baseline baseline[2]; /* [half of a split view, else 0]: baseline whose readings are subtracted; id 0: it shows no differences */
    /* copies of the readings used to draw the frame (render/frame_record.h); NULL: none were requested */
    struct frame_record *record;
    /* depth grid of the frame, or of each half of a split view, with which clients warp the picture for a moved camera; NULL: none */
    struct depth_grid *depth[2];
    /* hash of the view and of the versions of its fields, without sequence numbers and times; two frames with the same hash look the
       same */
    uint64_t content;
    int triangles;
};

/* Fills in values and qualities of the markers from the snapshot used to draw the frame, and removes markers behind the eye.
   Call this before other threads see the frame. baselines: for differences; NULL: there are none. */
void frame_read_markers(struct frame *frame, const struct snapshot *snapshot, struct baselines *baselines);
/* Creates a frame of this size; its pixels are undefined. Returns NULL when out of memory; the caller owns the frame
   (frame_unref). pool: pool from which the pixel buffer is taken; NULL: none */
struct frame *frame_create(struct frame_pool *pool, int width_px, int height_px);
/* Returns a frame that shows a part of `whole` and shares its pixels. The part must lie inside `whole`. Markers and labels in the part or
   near its edge are copied. Never NULL. */
struct frame *frame_cut(struct frame *whole, const struct frame_part *part);
struct frame *frame_ref(struct frame *frame);
void frame_unref(struct frame **frame);

#endif
