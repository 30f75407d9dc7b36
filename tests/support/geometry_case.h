/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Geometry that tests fill in. */
#ifndef TESTS_SUPPORT_GEOMETRY_CASE_H
#define TESTS_SUPPORT_GEOMETRY_CASE_H
#include "base/mem.h"
#include "preprocess/geometry/geometry.h"
#include "tests/support/no_textures.h"

/* Initialises a geometry that has no vertices yet, one empty primitive, and one material without textures. Allocates room for
   this many vertices and triangles, and for a second primitive and material. */
static inline void geometry_begin(struct geometry *g, size_t vertices, size_t triangles)
{
    *g = (struct geometry){ .primitive_count = 1, .material_count = 1 };
    g->positions_m = mem_array(vertices, sizeof(*g->positions_m));
    g->normals = mem_array(vertices, sizeof(*g->normals));
    g->indices = mem_array(3 * triangles, sizeof(*g->indices));
    g->primitives = mem_array(2, sizeof(*g->primitives));
    g->materials = mem_array(2, sizeof(*g->materials));
    g->materials[0] = g->materials[1] = (struct asset_material){ NO_TEXTURES };
}

#endif
