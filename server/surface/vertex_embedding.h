/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Vertex embedding: finds the positions of vertices on a surface that was not built from them, so that distances can be
   computed there. The vertices of an asset file need this: their order differs from the model's, and there are additional ones.
   Create and destroy from one thread; distances from any. */
#ifndef SURFACE_VERTEX_EMBEDDING_H
#define SURFACE_VERTEX_EMBEDDING_H
#include "surface/surface.h"

struct vertex_embedding;

/* Finds for each vertex the surface point at its position, or else the nearest visible surface point. Where faces coincide, the
 * face that points the same way as the vertex's own triangles is taken. triangles: of the finest level. Vertices that only
 * coarser levels use may be off the surface by more than a wall's thickness. So the nearest face whose normal fits theirs is
 * taken (normals NULL: the nearest face). Runs on the surface's workers. The surface must outlive the result. Logs and returns
 * NULL when out of memory. */
struct vertex_embedding *vertex_embedding_create(const struct surface *surface, const float (*positions_m)[3], const float (*normals)[3],
                                                 size_t count, const uint32_t *triangles, size_t triangle_count);
/* Frees the embedding and sets *embedding to NULL. *embedding may be NULL. */
void vertex_embedding_destroy(struct vertex_embedding **embedding);

/* Computes out[vertex], the geodesic distance in metres of each vertex from the surface point nearest to point_m. Logs and
   returns false if out of memory. */
bool vertex_embedding_distances(const struct vertex_embedding *embedding, const double point_m[3], float *out);

/* Returns the index of the surface point at a vertex's position. TRIMESH_NONE: the vertex is inside a triangle, or at a point
 * without a visible triangle. *hit is then its position, or the nearest visible surface point. */
uint32_t vertex_embedding_place(const struct vertex_embedding *embedding, size_t vertex, struct surface_point *hit);

#endif
