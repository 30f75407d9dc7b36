/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Triangle mesh with shared points, whose edges may have any number of faces. All steps of building a surface (surface.h), from
   welding to sampling, work on such a mesh. Call from one thread only; a const mesh can be read from any. */
#ifndef SURFACE_MESH_TRIMESH_H
#define SURFACE_MESH_TRIMESH_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define TRIMESH_NONE UINT32_MAX

struct trimesh {
    double (*points)[3];
    uint32_t (*tris)[3];
    uint32_t *tri_source; /* by triangle: index of the model triangle that it is a piece of */
    uint32_t *tri_times;  /* by triangle: number of model triangles with these three points; NULL: not counted */
    size_t point_count, point_capacity, tri_count, tri_capacity, source_capacity, times_capacity;
};

struct trimesh_model {
    const float (*positions)[3];
    size_t vertex_count;
    const uint32_t *triangles; /* three vertices each */
    size_t triangle_count;
};
/* Builds a mesh from a model, merging vertices closer than weld_m. Drops triangles without area (counted in *degenerate) and all but one of
 * several triangles with the same three points (counted in *repeated and in tri_times). vertex_point[vertex] receives the index of its
 * point. Returns false if out of memory. */
bool trimesh_weld(struct trimesh *mesh, const struct trimesh_model *model, double weld_m, uint32_t *vertex_point, size_t *degenerate,
                  size_t *repeated);
/* Frees the mesh. */
void trimesh_finish(struct trimesh *mesh);
/* Frees tri_times: the numbers of model triangles per triangle are no longer counted. */
void trimesh_stop_counting(struct trimesh *mesh);
/* Makes `copy` a deep copy of the mesh, without tri_times. `copy` must be initialised with zeros, or be a mesh whose content may be
 * overwritten. */
void trimesh_copy(struct trimesh *copy, const struct trimesh *mesh);

/* Returns whether the triangle has this point as a corner. */
bool trimesh_has(const struct trimesh *mesh, uint32_t tri, uint32_t point);

/* Appends a point. Returns the index of the point. */
uint32_t trimesh_add_point(struct trimesh *mesh, const double point[3]);
/* Appends a triangle of three points that is a piece of the model's triangle `source`. */
void trimesh_add_tri(struct trimesh *mesh, uint32_t a, uint32_t b, uint32_t c, uint32_t source);

/* Finds points to merge. target[point] receives the index of an earlier point at most within_m away, or the point's own index
 * if there is none. A point that is another's target is its own target. Returns false if out of memory. */
bool trimesh_find_twins(const struct trimesh *mesh, double within_m, uint32_t *target);
/* Removes triangles without area (adds their number to *degenerate) and duplicate triangles (adds to *repeated). */
void trimesh_clean(struct trimesh *mesh, size_t *degenerate, size_t *repeated);
/* Replaces each point i by point target[i]. Drops triangles that lost their area (adds their number to *degenerate) or became duplicates
   (adds to *repeated). */
void trimesh_rename(struct trimesh *mesh, const uint32_t *target, size_t *degenerate, size_t *repeated);

/* Adds points until no edge is longer than spacing_m or the mesh has point_limit points. First halves triangles whose height exceeds
 * spacing_m, then cuts long edges into equal parts. */
void trimesh_sample(struct trimesh *mesh, double spacing_m, size_t point_limit);

/* Writes to component[point] the lowest index of a point in its connected component. Returns the number of components that have
 * triangles. */
size_t trimesh_components(const struct trimesh *mesh, uint32_t *component);

/* Union-find: returns the root of i's set, which is the set's lowest index. Initially parent[i] = i. */
uint32_t trimesh_root(uint32_t *parent, uint32_t i);
/* Union-find: joins the sets that contain a and b. */
void trimesh_join(uint32_t *parent, uint32_t a, uint32_t b);

/* Writes a normal vector of the triangle; its length is twice the triangle's area. */
void trimesh_normal(const struct trimesh *mesh, size_t tri, double out[3]);
double trimesh_tri_area(const struct trimesh *mesh, size_t tri);
/* Returns the total area of all triangles, square metres. */
double trimesh_area(const struct trimesh *mesh);

/* Hash table of undirected edges: maps a pair of point indices, in either order, to an edge index, counted from 0. */
struct edge_table {
    uint64_t *keys;
    uint32_t *numbers;
    size_t mask, count;
};
/* Creates an empty table with room for about `expected` edges; the table grows when more are added. */
void edge_table_init(struct edge_table *table, size_t expected);
/* Frees the table. */
void edge_table_finish(struct edge_table *table);
/* Returns the edge's index. Adds the edge with index table->count if it is new. */
uint32_t edge_table_add(struct edge_table *table, uint32_t a, uint32_t b);
/* Returns the edge's index, or TRIMESH_NONE if the table does not contain it. */
uint32_t edge_table_find(const struct edge_table *table, uint32_t a, uint32_t b);
/* Prefetches the memory that a lookup of the edge will read. */
void edge_table_prefetch(const struct edge_table *table, uint32_t a, uint32_t b);
/* Prefetches the table entries for the edges of a triangle that comes a few places after `tri` in `tris`, if there is one. */
void edge_table_prefetch_ahead(const struct edge_table *table, const uint32_t (*tris)[3], size_t tri, size_t tri_count);

#endif
