/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds points on isolines where labels may be placed, spread over each asset, and tests which are visible in a frame. Does the
   same for positions of arrows (arrows.h). The lines themselves are drawn with the field (shaders/field.glsl). Call only in the
   thread that owns the GL context. */
#ifndef RENDER_PICK_ISOLINES_H
#define RENDER_PICK_ISOLINES_H
#include "render/frame.h"
#include "render/pick/arrows.h"
#include "render/pick/point_visibility.h"
#include "render/pick/strokes.h"

struct isoline_point {
    /* value: of the isoline, or of the field at an arrow, in the field's unit; place_m: position in the plant frame */
    double value, place_m[3];
    double along[3]; /* direction of an arrow in the plant frame; zero: unknown */
    bool arrow, uncertain;
    /* number of the stroke (short streamline) in this frame, from 1 up, the same for all of its points; 0: the point belongs to no
       stroke */
    uint16_t stroke;
    float slack_m;   /* depth tolerance in metres: how far the point may lie behind the drawn surface */
};
struct isoline_set { /* points of one asset */
    uint64_t content;
    double lines[VIEW_ALL_LINES];
    int line_count;
    struct isoline_point *points;
    size_t count, capacity;
};

struct isolines {
    /* by asset: points on isolines, where labels of isolines may be placed; `arrows` and `strokes` are indexed by asset, too */
    struct isoline_set *sets;
    struct arrow_set *arrows;
    struct stroke_set *strokes;
    size_t asset_count;
};
struct isoline_points { /* isoline points of one frame; zero-initialise, free `at` with mem_free() */
    struct isoline_point *at;
    size_t count, capacity;
    uint16_t stroke_count;
};

/* Returns whether frames of this view show the directions of a field by arrows or by strokes (short streamlines). Pure. */
bool isolines_has_arrows(const struct scene *scene, const struct view *view);
void isolines_init(struct isolines *isolines, size_t asset_count);
void isolines_finish(struct isolines *isolines);
/* Returns how many of the asset's vertices, counted from the first, need current field values because isolines_collect() reads
   them. Pure. */
size_t isolines_vertex_count(const struct scene_asset *asset);
/* Collects possible positions of labels and arrows on all visible assets; their visibility is tested later. context->fields
   must hold the fields shown. */
void isolines_collect(struct isolines *isolines, const struct frame_context *context, struct isoline_points *out);
/* isolines_start() begins the visibility test of isoline points and arrows on the GPU; call it after the multisampled frame is
   resolved. It logs and returns false when the GPU is out of memory. isolines_get() stores the result in the frame once the GPU
   is done. */
bool isolines_start(struct point_visibility *queries, const struct frame_context *context, const struct isoline_points *points);
void isolines_get(const struct point_visibility *queries, const struct frame_context *context, const struct isoline_points *points,
                  struct frame *frame);
/* Tests the visibility of isoline points and arrows on the CPU and adds the visible ones to the frame. Uses the frame's depth buffer: rows
   from the top, pitch_px floats apart. */
void isolines_find(const struct frame_context *context, const struct isoline_points *points, const float *depth, size_t pitch_px,
                   struct frame *frame);

#endif
