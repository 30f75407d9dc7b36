/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A heap of triangles that share points; edges may have any number of faces. The stage between a model and its Laplacian. */
#ifndef SURFACE_MESH_TRIMESH_H
#define SURFACE_MESH_TRIMESH_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define TRIMESH_NONE UINT32_MAX

struct trimesh {
    double (*points)[3];
    uint32_t (*tris)[3];
    uint32_t *tri_source; /* the model's triangle that this one is a piece of */
    uint32_t *tri_times;  /* how many of the model's lay there, each with the same three points; NULL: not counted (any more) */
    size_t point_count, point_capacity, tri_count, tri_capacity, source_capacity, times_capacity;
};

/* The model with vertices closer than weld_m made one. vertex_point[vertex] = point. Triangles without area are left out, and of
   triangles with the same three points all but one, which counts them. False: out of memory. */
bool trimesh_weld(struct trimesh *mesh, const float (*positions)[3], size_t vertex_count, const uint32_t *triangles, size_t triangle_count,
                  double weld_m, uint32_t *vertex_point, size_t *degenerate, size_t *repeated);
void trimesh_finish(struct trimesh *mesh);
void trimesh_stop_counting(struct trimesh *mesh);
/* copy: zero-initialised, or a mesh that is given up; it does not count. */
void trimesh_copy(struct trimesh *copy, const struct trimesh *mesh);

uint32_t trimesh_add_point(struct trimesh *mesh, const double point[3]);
void trimesh_add_tri(struct trimesh *mesh, uint32_t a, uint32_t b, uint32_t c, uint32_t source);

/* target[point]: the first point that lies within that distance of it, or itself. False: out of memory. */
bool trimesh_find_twins(const struct trimesh *mesh, double within_m, uint32_t *target);
/* Renames points (point[i] becomes target[i]) and drops triangles that lost their area or became repeated. */
void trimesh_rename(struct trimesh *mesh, const uint32_t *target, size_t *degenerate, size_t *repeated);

/* Adds points until no edge is longer than spacing_m, or there are point_limit points: triangles higher than that are halved, then long
   edges are cut into equal parts. */
void trimesh_sample(struct trimesh *mesh, double spacing_m, size_t point_limit);

/* component[point]: the lowest point that hangs together with it. Returns how many there are among points that have triangles. */
size_t trimesh_components(const struct trimesh *mesh, uint32_t *component);

/* Sets that grow together: parent[i] = i at first; the root is the lowest member. */
uint32_t trimesh_root(uint32_t *parent, uint32_t i);
void trimesh_join(uint32_t *parent, uint32_t a, uint32_t b);

/* Along the triangle's normal, and twice as long as it is large. */
void trimesh_normal(const struct trimesh *mesh, size_t tri, double out[3]);
double trimesh_tri_area(const struct trimesh *mesh, size_t tri);
double trimesh_area(const struct trimesh *mesh);

/* Edges in a hash table: (a, b) in any order -> a number from 0. */
struct edge_table {
    uint64_t *keys;
    uint32_t *numbers;
    size_t mask, count;
};
void edge_table_init(struct edge_table *table, size_t expected);
void edge_table_finish(struct edge_table *table);
/* The edge's number; a new edge gets table->count. */
uint32_t edge_table_add(struct edge_table *table, uint32_t a, uint32_t b);
uint32_t edge_table_find(const struct edge_table *table, uint32_t a, uint32_t b); /* TRIMESH_NONE: not there */
void edge_table_prefetch(const struct edge_table *table, uint32_t a, uint32_t b); /* it will be asked for soon */

#endif
