/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A camera in the plant frame (metres, Z up) and its matrices. Column-major; GL clip space, depth -1..1. */
#ifndef SCENE_CAMERA_H
#define SCENE_CAMERA_H
#include <stdbool.h>

struct camera {
    double eye_m[3], target_m[3], up[3];
    double fov_deg; /* vertical */
};

/* Finite, eye apart from target, up not along the view, 1 <= fov <= 120, all |m| <= 1e6. */
bool camera_valid(const struct camera *camera);
/* Looks at the whole box from a raised corner (south-west unless the plant says otherwise). */
void camera_fit(struct camera *camera, const double min_m[3], const double max_m[3], double aspect);
/* near and far planes are chosen to hold the box. view_from_plant and clip_from_view, each 16 doubles. */
void camera_matrices(const struct camera *camera, double aspect, const double min_m[3], const double max_m[3],
                     double view[16], double projection[16]);

#endif
