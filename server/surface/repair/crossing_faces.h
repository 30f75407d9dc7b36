/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the faces of a model that may pass through others, before the surface is sampled. Sampling later cuts each face into pieces (dozens
   in a coarse model), and only pieces of the faces found here must be tested for crossings. */
#ifndef SURFACE_REPAIR_CROSSING_FACES_H
#define SURFACE_REPAIR_CROSSING_FACES_H
#include "surface/repair/parts.h"

/* minimum distance of both ends of an edge from the plane of a face of the same part for the edge to count as crossing the
   face. Unit: the part's reach (distance up to which other surfaces count as touching it, parts.h) */
#define CROSSING_CLEAR 0.05

/* Returns by model triangle: 1 if an edge of one of its triangles in parts->solid (the surface before sampling) may pass
 * through another face, else 0. May flag a face that does not cross, but misses none that does. Faces of one part that only
 * share a corner or an edge do not cross. NULL: no face crosses. The caller frees the array (mem_free). Call from any thread.
 * */
char *crossing_faces_find(const struct body_parts *parts);

#endif
