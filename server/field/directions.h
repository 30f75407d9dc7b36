/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Vectors on a surface: where the values of a group point whose sensors have directions (tag list, `Direction`). A vector's length is the
   field's value, interpolated as ever. Its direction is that of sum_i w_i v_i with w_i = s_i / D_i^p, where v_i are the sensors' vectors,
   carried to the place along the surface (parallel transport, prepared: preprocess/influence/transport.h): so opposite vectors on two sides
   of a sphere do not cancel out in between only because they point to opposite sides in space.
   A direction is unknown where no sensor that has one reaches, where one whose direction or reading is lost is nearer than all others, and
   where vectors do cancel: |sum| < DIRECTION_LEAST of what they would add up to in parallel. Of a vector that stands almost upright on
   the surface nothing is known either. Thread: any that may read the scene. */
#ifndef FIELD_DIRECTIONS_H
#define FIELD_DIRECTIONS_H
#include "field/params.h"
#include "scene/scene.h"
#include "value/snapshot.h"

#define DIRECTION_LEAST 0.2

struct sensor_direction {
    float vector[3]; /* in the axes of the asset file; as long as the reading */
    bool configured; /* has a direction */
    bool known;      /* reading and direction are good, or at least Uncertain: */
    bool uncertain;
};
/* Reads what the sensors of the group on the asset say, in the order of the prepared ones. Returns their number, 0: nothing is shown; the
   caller frees *out (mem_free). */
size_t directions_read(const struct scene *scene, int asset, int group, const struct snapshot *snapshot, struct sensor_direction **out);

struct direction_place { /* a point of a triangle of the asset file */
    uint32_t corners[3];
    float weights[3], normal[3];
    uint32_t triangle; /* its number, as whoever placed it counts them; directions_find() does not look at it */
};
struct direction {
    float along[3]; /* unit, tangent, in the axes of the asset file */
    bool known, uncertain;
};
/* Finds the direction at each place from what directions_read() gave. */
void directions_find(const struct scene *scene, int asset, const struct field_params *params, const struct sensor_direction *sensors,
                     size_t sensor_count, const struct direction_place *places, size_t place_count, struct direction *out);

#endif
