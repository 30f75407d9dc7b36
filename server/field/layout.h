/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which sensors of one group stand on one asset, and how far every vertex is from them. Thread: one. */
#ifndef FIELD_LAYOUT_H
#define FIELD_LAYOUT_H
#include "base/workers.h"
#include "plant/plant.h"
#include "scene/scene.h"

struct layout_sensor {
    int tag;               /* in plant->tags */
    uint32_t column;       /* in the asset file's sensors */
    float strength, decay; /* as configured, >= 0 */
};

struct layout {
    const struct asset *file;
    const struct plant_group *group;
    const struct plant_tag *tags; /* of the plant */
    struct layout_sensor *sensors;
    size_t sensor_count, vertex_count;
    float largest_m[2]; /* by distance_mode; 0: not looked for yet */
};

/* NULL: no sensor of the group on the asset. scene must outlive it. */
struct layout *layout_create(const struct scene *scene, int asset, int group);
void layout_destroy(struct layout **layout); /* &NULL is fine; leaves NULL */
/* Distances of `count` vertices from `begin` on from one sensor: in the file, or made in scratch. Euclidean ones are taken from
   the sensor's place on the surface, so that both kinds are 0 at the same point. */
const float *layout_distances(const struct layout *layout, enum distance_mode mode, size_t sensor, size_t begin, size_t count,
                              float *scratch);
/* The largest finite distance of any vertex from any of the sensors; 1 where all are 0 or infinite. Kept. */
float layout_largest(struct layout *layout, enum distance_mode mode, struct workers *workers);

#endif
