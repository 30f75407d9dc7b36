/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fields that pictures show exactly: if a group uses straight-line distances and has at most EXACT_SENSORS sensors on an asset, the field
   is evaluated at each pixel (field/pixel_field.h). plantcast-prep does not subdivide triangles for such fields. Thread: any. */
#ifndef PLANT_EXACT_H
#define PLANT_EXACT_H
#include "plant/influence.h"
#include "plant/plant.h"

/* Largest number of sensors that a group may have on an asset for its field to be evaluated at each pixel. With 512 sensors a preview
   would take 2.6 times as long as with a field that is interpolated between vertices, with 64 sensors 1.3 times. */
enum { EXACT_SENSORS = 64 };

/* Returns whether a field from that many sensors, with this interpolation and kind of distance, is evaluated at each pixel. */
static inline bool plant_is_exact(enum interpolation interpolation, enum distance_mode distance, size_t sensor_count)
{
    bool by_distance = interpolation == INTERPOLATION_SHEPARD || interpolation == INTERPOLATION_PAPER;
    return by_distance && distance == DISTANCE_EUCLIDEAN && sensor_count <= EXACT_SENSORS;
}
/* Returns whether plantcast-prep need not subdivide triangles for this group on an asset with that many of its sensors. */
static inline bool plant_group_is_exact(const struct plant_group *group, size_t sensor_count)
{
    return plant_is_exact(group->interpolation, group->distance, sensor_count) && !plant_prepares_any(group);
}

#endif
