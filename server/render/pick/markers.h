/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the sensors of the shown group in the picture, and which of them are hidden. Thread: the one of the GL context. */
#ifndef RENDER_PICK_MARKERS_H
#define RENDER_PICK_MARKERS_H
#include "render/frame.h"
#include "render/pick/point_visibility.h"

/* All sensors one after another, each where it stands: as prepared, or as somebody tries it out. */
struct marker_iterator {
    const struct scene *scene;
    const struct trial *trial;   /* NULL: none */
    size_t asset, sensor, tried; /* begin at 0 */
};
struct marker_place {
    int tag, asset;
    const double *surface_m; /* plant frame */
};
bool marker_next(struct marker_iterator *iterator, struct marker_place *out); /* false: that was all */
bool marker_is_shown(const struct scene *scene, const struct view *view, const struct marker_place *place);

/* A marker sits on the surface; curved triangles may put it so far behind. */
double markers_slack_m(const struct scene_asset *asset);
/* Started once the picture is resolved; read into the frame when the GPU is done with it. False: out of GPU memory, logged. */
bool markers_start(struct point_visibility *queries, const struct frame_context *context);
void markers_get(const struct point_visibility *queries, const struct frame_context *context, struct frame *frame);
/* The same by the processor, from a picture's depth: rows from the top, pitch_px apart. */
void markers_find(const struct frame_context *context, const float *depth, size_t pitch_px, struct frame *frame);
/* As shaders/point_visibility.comp. place: eye space, and how far it may lie behind the surface; becomes x, y in pixels, hidden 0 or 1. */
void markers_look(const struct frame_context *context, const float *depth, size_t pitch_px, float place[4]);

#endif
