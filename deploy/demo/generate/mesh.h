/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An indexed triangle mesh under construction: positions and normals, one material. */
#ifndef GENERATE_MESH_H
#define GENERATE_MESH_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "vec.h"

struct mesh_vertex {
    float position[3], normal[3];
};

struct mesh { /* zero-initialise */
    struct mesh_vertex *vertices;
    uint32_t *indices; /* three per triangle, counter-clockwise from outside */
    size_t vertex_count, vertex_capacity, index_count, index_capacity;
};

void mesh_finish(struct mesh *mesh);
uint32_t mesh_vertex(struct mesh *mesh, struct vec position, struct vec normal);
void mesh_triangle(struct mesh *mesh, uint32_t a, uint32_t b, uint32_t c);
/* Corners counter-clockwise from outside; flat, with vertices of its own. */
void mesh_quad(struct mesh *mesh, struct vec a, struct vec b, struct vec c, struct vec d);
struct vec mesh_position(const struct mesh *mesh, size_t vertex);
/* The nearest point of the surface and the facet's normal there. False: the mesh is empty. */
bool mesh_nearest(const struct mesh *mesh, struct vec point, struct vec *surface, struct vec *normal);

#endif
