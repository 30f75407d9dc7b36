/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Projects the sensors of the shown group into the frame and tests which sensors are hidden. Call only in the thread that owns the
   GL context. */
#ifndef RENDER_PICK_MARKERS_H
#define RENDER_PICK_MARKERS_H
#include "render/frame.h"
#include "render/pick/point_visibility.h"

/* Iterator over all sensors and their positions: positions from the prepared asset file, or as moved by a trial. */
struct marker_iterator {
    const struct scene *scene;
    const struct trial *trial;   /* NULL: none */
    size_t asset, sensor, tried; /* zero-initialise */
};
struct marker_place {
    int tag, asset;
    const double *surface_m; /* position of the sensor on the surface, in the plant frame */
};
/* Writes the next sensor and its position to `out`. Returns false after the last one. */
bool marker_next(struct marker_iterator *iterator, struct marker_place *out);
/* Returns whether the view shows a marker for this sensor. The view must show the sensor's group, and the sensor's asset must be
   neither hidden nor cut away by a section plane at the sensor. */
bool marker_is_shown(const struct scene *scene, const struct view *view, const struct marker_place *place);

/* Returns the depth tolerance of an asset's markers: how far in front of a sensor's position the drawn surface may lie. */
double markers_slack_m(const struct scene_asset *asset);
/* markers_start() begins the visibility test of the sensors' markers on the GPU; call it after the multisampled frame is
   resolved. It logs and returns false when the GPU is out of memory. markers_get() stores the result in the frame once the GPU
   is done. */
bool markers_start(struct point_visibility *queries, const struct frame_context *context);
void markers_get(const struct point_visibility *queries, const struct frame_context *context, struct frame *frame);
/* Recomputes the values of a frame's markers in a view of distances from a sensor; their positions stay unchanged. */
void markers_measure(const struct frame_context *context, struct frame *frame);
/* Tests the visibility of the markers on the CPU and stores the result in the frame. Uses the frame's depth buffer: rows from the top,
   pitch_px floats apart. */
void markers_find(const struct frame_context *context, const float *depth, size_t pitch_px, struct frame *frame);
/* Tests the visibility of one point, like shaders/point_visibility.comp. place, before the call: eye-space position and depth
   tolerance in metres; after it: x and y in pixels, then 1 if the point is hidden, else 0. */
void markers_look(const struct frame_context *context, const float *depth, size_t pitch_px, float place[4]);

#endif
