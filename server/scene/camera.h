/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A camera in the plant frame (metres) and its matrices. Column-major; GL clip space, depth -1..1. Thread: any. */
#ifndef SCENE_CAMERA_H
#define SCENE_CAMERA_H
#include <stdbool.h>

#include "plant/plant.h"

#define CAMERA_NEAR_TO_FAR 1e-4 /* least ratio of near to far plane: 24 bits of depth must resolve near parts */

struct camera {
    double eye_m[3], target_m[3], up[3];
    double fov_deg;  /* vertical */
    double height_m; /* what an orthographic picture is high; 0: perspective */
};

/* Finite, eye apart from target, up not along the view, 1 <= fov <= 120, or 1e-5 <= height; nothing beyond PLANT_MAX_M. */
bool camera_valid(const struct camera *camera);
/* Looks at the whole box, filling the picture, from the plant's raised south-west corner: x is east; north is y in a Z-up frame and -z in
   a Y-up one. Sets every field. */
void camera_fit_up(struct camera *camera, enum axis up, const double min_m[3], const double max_m[3], double aspect);
struct camera_window { /* a part of the picture, each way from -1 to 1. Zero: all of it */
    double left, right, bottom, top;
};
/* The same in a direction that is not along camera->up, with the lens and the up of `camera`: of an orthographic one, height_m > 0, the
   height is chosen. It fills that window. */
void camera_fit_along(struct camera *camera, const double forward[3], const double min_m[3], const double max_m[3], double aspect,
                      const struct camera_window *window);
/* Does the same for count >= 1 points: a perspective camera fits the points themselves, an orthographic one their bounding box. */
void camera_fit_points(struct camera *camera, const double forward[3], const double (*points_m)[3], size_t count, double aspect,
                       const struct camera_window *window);
/* Unit vectors of the picture. */
void camera_basis(const struct camera *camera, double right[3], double up[3], double forward[3]);
/* From so far off, an eye of the usual angle sees as much as an orthographic picture shows. 0: perspective. */
double camera_parallel_m(const struct camera *camera);
/* near and far planes are chosen to hold the box: in an orthographic picture also what of it lies behind the eye.
   view_from_plant and clip_from_view, each 16 doubles. */
void camera_matrices(const struct camera *camera, double aspect, const double min_m[3], const double max_m[3], double view[16],
                     double projection[16]);

#endif
