/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From where to look at a place that something may stand before: cameras to be tried in order, the best first, and where around the place
   nothing should stand either. clients/web/core/approach.js says the same. Pure; any thread. */
#ifndef WALL_APPROACH_H
#define WALL_APPROACH_H
#include "scene/camera.h"

enum { APPROACH_SIDES = 24, APPROACH_AROUND = 8 };

/* Around the place, in heights of the picture: to the right, down. */
extern const double approach_around[APPROACH_AROUND][2];
/* The first camera, turned about the place towards a side, 0..APPROACH_SIDES-1. The first side is the camera as it is. */
struct camera approach_camera(const struct camera *first, const double place_m[3], int side);

#endif
