/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A camera in the plant frame (metres) and its matrices. Column-major; GL clip space, depth -1..1. Call from any thread. */
#ifndef SCENE_CAMERA_H
#define SCENE_CAMERA_H
#include <stdbool.h>

#include "plant/plant.h"

/* smallest ratio of near to far plane distance; a smaller one would exceed the precision of a 24-bit depth buffer */
#define CAMERA_NEAR_TO_FAR 1e-4

struct camera {
    double eye_m[3], target_m[3], up[3];
    double fov_deg;  /* vertical angle of view, degrees */
    double height_m; /* height of an orthographic picture in metres; 0: perspective camera */
};

/* Returns whether all numbers are finite and within PLANT_MAX_M, the eye differs from the target, up is not along the view, and 1 <=
   fov_deg <= 120 or height_m >= 1e-5. */
bool camera_valid(const struct camera *camera);
/* Frames the whole box, seen from above the plant's south-west corner: x points east; y points north in a Z-up frame, -z in a
 * Y-up frame. Sets every member. */
void camera_fit_up(struct camera *camera, enum axis up, const double min_m[3], const double max_m[3], double aspect);
struct camera_window { /* rectangle of the picture, in coordinates from -1 to 1 along each axis; all zero: the whole picture */
    double left, right, bottom, top;
};
/* Frames the box within a window of the picture, looking along `forward`, which must not be along camera->up. Keeps the
   camera's lens and up vector; an orthographic camera (height_m > 0) gets a new height. */
void camera_fit_along(struct camera *camera, const double forward[3], const double min_m[3], const double max_m[3], double aspect,
                      const struct camera_window *window);
/* Frames count >= 1 points: a perspective camera frames the points themselves, an orthographic one their bounding box. */
void camera_fit_points(struct camera *camera, const double forward[3], const double (*points_m)[3], size_t count, double aspect,
                       const struct camera_window *window);
/* Writes the unit vectors of the picture's axes: right, up, and forward. */
void camera_basis(const struct camera *camera, double right[3], double up[3], double forward[3]);
/* Returns the distance from which a perspective camera with the default angle sees as much as this camera's orthographic
   picture shows. 0: this camera is perspective. */
double camera_parallel_m(const struct camera *camera);
/* Computes two column-major matrices: view, from plant to eye space, and projection, from eye to clip space. Near and far
   planes enclose the box; in an orthographic picture, even the part of the box behind the eye. */
void camera_matrices(const struct camera *camera, double aspect, const double min_m[3], const double max_m[3], double view[16],
                     double projection[16]);

#endif
