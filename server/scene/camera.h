/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A camera in the plant frame (metres) and its matrices. Column-major; GL clip space, depth -1..1. Thread: any. */
#ifndef SCENE_CAMERA_H
#define SCENE_CAMERA_H
#include <stdbool.h>

#include "plant/plant.h"

struct camera {
    double eye_m[3], target_m[3], up[3];
    double fov_deg; /* vertical */
};

/* Finite, eye apart from target, up not along the view, 1 <= fov <= 120, all |m| <= 1e6. */
bool camera_valid(const struct camera *camera);
/* Looks at the whole box, filling the picture, from a raised south-west corner of a plant that is Z up. Sets every field. */
void camera_fit(struct camera *camera, const double min_m[3], const double max_m[3], double aspect);
/* The same for either kind of plant frame: x is east; north is y in a Z-up frame and -z in a Y-up one. */
void camera_fit_up(struct camera *camera, enum axis up, const double min_m[3], const double max_m[3], double aspect);
/* near and far planes are chosen to hold the box. view_from_plant and clip_from_view, each 16 doubles. */
void camera_matrices(const struct camera *camera, double aspect, const double min_m[3], const double max_m[3], double view[16],
                     double projection[16]);

#endif
