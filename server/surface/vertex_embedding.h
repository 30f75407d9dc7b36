/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Vertex embedding: attaches vertices that a surface was not built from to points on it, so that distances can be computed at them. Such
   are the vertices of an asset file: in another order and with additional ones. Thread: create and destroy from one thread; distances from
   any. */
#ifndef SURFACE_VERTEX_EMBEDDING_H
#define SURFACE_VERTEX_EMBEDDING_H
#include "surface/surface.h"

struct vertex_embedding;

/* Attaches each vertex to the surface point at its position, else to the nearest visible one; where faces coincide, to the one that faces
   as the vertex's own triangles do. triangles: of the finest level. Vertices that only coarser levels have may be off the surface by more
   than a wall's thickness, and are attached to the nearest face that looks along their normal (normals NULL: to the nearest face). The
   surface must outlive the embedding. Runs on the surface's workers. Returns NULL when out of memory, logged. */
struct vertex_embedding *vertex_embedding_create(const struct surface *surface, const float (*positions_m)[3], const float (*normals)[3],
                                                 size_t count, const uint32_t *triangles, size_t triangle_count);
/* Frees the embedding. &NULL is fine; sets it to NULL. */
void vertex_embedding_destroy(struct vertex_embedding **embedding);

/* Computes out[vertex], the geodesic distance in metres of each vertex from the surface point nearest to point_m. Returns false if out of
   memory, logged. */
bool vertex_embedding_distances(const struct vertex_embedding *embedding, const double point_m[3], float *out);

/* Returns the surface point that a vertex is attached to. Returns TRIMESH_NONE if it is attached inside a triangle, described by *hit, or
   to a point without a visible triangle; *hit is then the nearest visible surface point. */
uint32_t vertex_embedding_place(const struct vertex_embedding *embedding, size_t vertex, struct surface_point *hit);

#endif
