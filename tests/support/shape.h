/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Simple solids for tests: triangles in metres, Z up; each call adds one primitive. */
#ifndef TESTS_SUPPORT_SHAPE_H
#define TESTS_SUPPORT_SHAPE_H
#include <stddef.h>
#include <stdint.h>

#include "protocol/asset_format.h"

struct test_shape { /* zero-initialise */
    float (*positions)[3], (*normals)[3];
    uint32_t *indices;
    struct asset_primitive *primitives;
    /* Materials, textures and texture coordinates, which the caller owns. NULL: the materials of toy.h, without textures. */
    const struct asset_material *materials;
    const struct asset_texture *textures;
    const uint8_t *texels;
    const float (*texcoords)[2];
    size_t material_count, texture_count, texel_bytes;
    size_t vertex_count, index_count, primitive_count;
    size_t position_capacity, normal_capacity, index_capacity, primitive_capacity;
};

/* Adds a grid of n x n squares in a plane through `corner`, along u and v; its normal is u x v. */
void shape_plate(struct test_shape *shape, uint32_t material, const double corner[3], const double u[3], const double v[3], int n);
void shape_box(struct test_shape *shape, uint32_t material, const double low[3], const double high[3]);
/* Adds a cylinder or cone around the line from a to b, with radius ra at a and rb at b. round 0: flat caps at the ends;
   otherwise round caps. */
void shape_cylinder(struct test_shape *shape, uint32_t material, const double a[3], const double b[3], double ra, double rb, int round);
/* Adds a sphere whose surface is a grid of 2 n squares around and n from pole to pole. */
void shape_sphere(struct test_shape *shape, uint32_t material, const double middle[3], double radius, int n);
void shape_finish(struct test_shape *shape);

#endif
