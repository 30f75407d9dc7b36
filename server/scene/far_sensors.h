/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sensors that lie too far from the surface of their asset to be believed. */
#ifndef SCENE_FAR_SENSORS_H
#define SCENE_FAR_SENSORS_H
#include "scene/scene.h"

struct far_sensor {
    const struct scene_asset *asset;
    const struct scene_sensor *sensor;
    double limit_m; /* 0.25 m, or 5 % of the asset's size, whichever is less */
};

/* Sorted, farthest first. Free with mem_free. */
struct far_sensor *far_sensors_find(const struct scene *scene, size_t *count);
/* Returns the distance from the asset's surface beyond which a sensor is worth a word: it may stand on something else, or its numbers are
   wrong. 0.25 m, or 5 % of the diagonal of the asset's bounds, whichever is less. */
double far_limit_m(const struct scene_asset *asset);

#endif
