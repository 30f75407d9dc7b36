/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where isolines may be labelled: points on them, spread over each asset, and which of them a picture shows. The lines themselves are
   drawn with the field (shaders/field.glsl). Thread: the one of the GL context. */
#ifndef RENDER_PICK_ISOLINES_H
#define RENDER_PICK_ISOLINES_H
#include "render/frame.h"
#include "render/pick/point_visibility.h"

struct isoline_point {
    double value, place_m[3]; /* plant frame */
    float slack_m;            /* may lie that far behind the surface that is drawn */
};
struct isoline_set { /* of one asset */
    uint64_t content;
    double lines[VIEW_ALL_LINES];
    int line_count;
    struct isoline_point *points;
    size_t count, capacity;
};

struct isolines {
    struct isoline_set *sets; /* by asset */
    size_t asset_count;
};
struct isoline_points { /* those of a picture; zero-initialise, free `at` with mem_free */
    struct isoline_point *at;
    size_t count, capacity;
};

void isolines_init(struct isolines *isolines, size_t asset_count);
void isolines_finish(struct isolines *isolines);
/* So many of the first vertices of an asset must be up to date for its labels. */
size_t isolines_vertex_count(const struct scene_asset *asset);
/* While context->fields are what is shown: which points there are. */
void isolines_collect(struct isolines *isolines, const struct frame_context *context, struct isoline_points *out);
/* Started once the picture is resolved; read into the frame when the GPU is done with it. False: out of GPU memory, logged. */
bool isolines_start(struct point_visibility *queries, const struct frame_context *context, const struct isoline_points *points);
void isolines_get(const struct point_visibility *queries, const struct isoline_points *points, struct frame *frame);
/* The same two by the processor, from a picture's depth: rows from the top, pitch_px apart. */
void isolines_find(const struct frame_context *context, const struct isoline_points *points, const float *depth, size_t pitch_px,
                   struct frame *frame);

#endif
