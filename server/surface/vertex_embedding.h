/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Vertices that a surface was not made from, held fast on it: those of an asset file, which has some more than its model and another order.
   Thread: create and destroy from one thread; distances from any. */
#ifndef SURFACE_VERTEX_EMBEDDING_H
#define SURFACE_VERTEX_EMBEDDING_H
#include "surface/surface.h"

struct vertex_embedding;

/* Each at the surface's point of the same place; else at the nearest spot that is seen, and where faces lie on each other, on that which
   looks the same way as its own triangles. triangles: the finest level's; vertices that only coarser ones have may stand farther off than
   a wall is thick, and are on the nearest face that looks along their normal (normals may be NULL: on the nearest face). surface must
   outlive it, the others need not. NULL: out of memory, logged. Spread over the surface's workers. */
struct vertex_embedding *vertex_embedding_create(const struct surface *surface, const float (*positions_m)[3], const float (*normals)[3],
                                                 size_t count, const uint32_t *triangles, size_t triangle_count);
void vertex_embedding_destroy(struct vertex_embedding **embedding); /* &NULL is fine; leaves NULL */

/* out[vertex]: metres along the surface from the place nearest to point_m. False: out of memory, logged. */
bool vertex_embedding_distances(const struct vertex_embedding *embedding, const double point_m[3], float *out);

#endif
