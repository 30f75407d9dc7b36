/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Vectors on a surface, for groups whose sensors have directions (column `Direction` of the tag list). A vector's length is the
   field's value, interpolated as usual. Its direction is that of sum_i w_i v_i with w_i = s_i / D_i^p, where v_i are the
   sensors' vectors after parallel transport along the surface to the point (prepared: preprocess/influence/transport.h). So
   vectors on two sides of a sphere do not cancel in between merely because they point in opposite directions in space. D_i are
   the distances of the point itself, also inside large triangles, as field_at() uses them (layout_distances() in layout.h). A
   direction is unknown where no sensor with a direction reaches, and where a sensor without a usable direction or reading is
   nearest. It is also unknown where vectors cancel (|sum| < DIRECTION_LEAST times the sum of their lengths), and where a vector
   is nearly perpendicular to the surface. Call from any thread that may read the scene. */
#ifndef FIELD_DIRECTIONS_H
#define FIELD_DIRECTIONS_H
#include "field/params.h"
#include "scene/scene.h"
#include "value/snapshot.h"

#define DIRECTION_LEAST 0.2

struct sensor_direction {
    float vector[3]; /* the sensor's vector in the axes of the asset file: its direction is measured, its length is the reading's value */
    bool configured; /* the sensor has a direction */
    bool known;      /* true: reading and direction are usable (quality Good or Uncertain) */
    bool uncertain;
};
/* Reads the vectors of the group's sensors on the asset, in the order of the prepared sensors. Returns the number of vectors;
   0: the asset has no directions to show. The caller frees *out (mem_free). */
size_t directions_read(const struct scene *scene, int asset, int group, const struct snapshot *snapshot, struct sensor_direction **out);

struct direction_place { /* a point on a triangle of the asset file */
    uint32_t corners[3];
    float weights[3], normal[3];
    uint32_t triangle; /* index of the triangle in the asset file; directions_find() does not use it, it is kept for the caller */
};
struct direction {
    float along[3]; /* direction of the interpolated vector: a unit vector tangent to the surface, in the axes of the asset file */
    bool known, uncertain;
};
struct direction_sources { /* vectors of an asset's sensors, from which directions at other points are interpolated */
    const struct scene *scene;
    int asset;
    const struct field_params *params;
    const struct sensor_direction *sensors; /* from directions_read() */
    size_t sensor_count;
};
/* Computes the direction of the interpolated vector at each of `count` points of the surface. */
void directions_find(const struct direction_sources *sources, const struct direction_place *places, size_t count, struct direction *out);

#endif
