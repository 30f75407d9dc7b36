/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Vertex embedding: vertices that a surface was not built from (those of an asset file, which has additional ones in another order)
   attached to their points on it, so that distances can be computed at them. Thread: create and destroy from one thread; distances from
   any. */
#ifndef SURFACE_VERTEX_EMBEDDING_H
#define SURFACE_VERTEX_EMBEDDING_H
#include "surface/surface.h"

struct vertex_embedding;

/* Attaches each vertex to the surface point at its position, else to the nearest visible one; where faces lie on each other, to the one
   that faces as the vertex's own triangles do. triangles: the finest level's. Vertices that only coarser levels have may be off the surface
   by more than a wall is thick, and go to the nearest face that looks along their normal (normals NULL: to the nearest face). The surface
   must outlive the embedding. Returns NULL if out of memory, logged. Spread over the surface's workers. */
struct vertex_embedding *vertex_embedding_create(const struct surface *surface, const float (*positions_m)[3], const float (*normals)[3],
                                                 size_t count, const uint32_t *triangles, size_t triangle_count);
/* Frees the embedding. &NULL is fine; leaves NULL. */
void vertex_embedding_destroy(struct vertex_embedding **embedding);

/* Computes out[vertex], the geodesic distance in metres of each vertex from the surface point nearest to point_m. Returns false if out of
   memory, logged. */
bool vertex_embedding_distances(const struct vertex_embedding *embedding, const double point_m[3], float *out);

/* Returns the point of the surface that a vertex is attached to, or TRIMESH_NONE, and then *hit says where it is. A point without a visible
   triangle counts as none: then *hit is the nearest visible place. */
uint32_t vertex_embedding_place(const struct vertex_embedding *embedding, size_t vertex, struct surface_point *hit);

#endif
