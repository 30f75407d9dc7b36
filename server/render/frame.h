/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A rendered picture and what it means. Immutable once handed out; counted; may be released on any thread. */
#ifndef RENDER_FRAME_H
#define RENDER_FRAME_H
#include <stddef.h>
#include <stdint.h>

#include "render/view.h"

#define FRAME_BEHIND_PX (-1e4f) /* x of a marker behind the eye */

struct frame_marker {
    int tag;
    float x_px, y_px; /* from the top left; may lie outside */
    uint8_t occluded; /* behind something, or outside the picture */
    uint32_t quality; /* of the reading that the picture shows; of a difference: the worse of both; and below */
    double value;     /* 0 where quality is Bad; of a difference: now less then; of a distance: metres, NAN where none is known */
    uint8_t half;     /* of a split view: 1 is the right one */
};

struct frame_label { /* a place on an isoline, or of an arrow, in sight */
    double value;
    float x_px, y_px;
    float dx, dy; /* of an arrow: where it points in the picture, at most 1 long, shorter where it points away; 0, 0: not known where */
    uint8_t half, arrow, uncertain;
    uint16_t stroke; /* of a point of a stroke: its number in the half, the same for those that follow it; 0: an arrow */
};
#define FRAME_ARROW_PX(width_px) fmax(48, (width_px) / 24.0) /* between arrows, at least; the longest is almost as long */

struct frame_part { /* of a picture, in its pixels, from the top left. width_px 0: all of it */
    int x_px, y_px, width_px, height_px;
};

struct frame {
    _Atomic int refs;
    struct view view; /* what it was drawn with */
    int width_px, height_px, stride_bytes;
    uint8_t *bgrx;                /* 4 bytes per pixel, rows from the top */
    struct frame *whole;          /* whose pixels these are, a reference; NULL: its own */
    struct frame_marker *markers; /* sensors of the shown group */
    size_t marker_count;
    struct frame_label *labels; /* where isolines may be labelled, more than there is room for; and arrows */
    size_t label_count;
    int64_t data_utc_ns;                      /* of the snapshot it shows */
    bool clock_unset;                         /* nothing kept the clock right that told it */
    int64_t oldest_age_ns;                    /* INT64_MAX: no value takes part */
    double drawn_error;                       /* in the unit of values, rounded up: places marked uncertain may be so far off; 0: none is */
    int64_t field_ns, render_ns, readback_ns; /* stage times */
    int64_t turn_ns;                          /* of the render thread for it, whatever held it up; 0: drawn elsewhere */
    struct baseline baseline;                 /* of a difference; id 0: none */
    struct frame_record *record;              /* what it was drawn from (render/frame_record.h); NULL: nobody asked for it */
    uint64_t content;                         /* equal for equal pictures: hash of view and field versions, without seq numbers and times */
    int triangles;
};

/* What the snapshot that the picture was drawn from says of its markers; those behind the eye go. Before the frame is shared.
   baselines: of differences; NULL: there are none. */
void frame_read_markers(struct frame *frame, const struct snapshot *snapshot, struct baselines *baselines);
struct frame *frame_create(int width_px, int height_px); /* NULL: out of memory */
/* Creates a picture of a part, which must lie in the whole; pixels are shared. Its markers and labels are those near the part. Never
   NULL. */
struct frame *frame_cut(struct frame *whole, const struct frame_part *part);
struct frame *frame_ref(struct frame *frame);
void frame_unref(struct frame **frame);
/* Any thread: pixels of all frames that are there, and of some that are gone, for the next. */
size_t frame_bytes(void);
void frame_drop_spares(void); /* drops the latter */

#endif
