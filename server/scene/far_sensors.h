/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds sensors that are implausibly far from the surface of their asset. */
#ifndef SCENE_FAR_SENSORS_H
#define SCENE_FAR_SENSORS_H
#include "scene/scene.h"

struct far_sensor {
    const struct scene_asset *asset;
    const struct scene_sensor *sensor;
    /* distance in metres from the surface above which a sensor counts as far: the smaller of 0.25 m and 5 % of the asset's size */
    double limit_m;
};

/* Returns the sensors that are farther from their asset's surface than the limit, farthest first. Free with mem_free. */
struct far_sensor *far_sensors_find(const struct scene *scene, size_t *count);
/* Returns the distance from the asset's surface above which a sensor causes a warning: the smaller of 0.25 m and 5 % of the
 * diagonal of the asset's bounds. Such a sensor may belong to another asset, or its coordinates may be wrong. */
double far_limit_m(const struct scene_asset *asset);

#endif
