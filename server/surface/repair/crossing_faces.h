/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the faces of a model that may pass through others, before the surface is sampled: sampling cuts each face into pieces, dozens of
   them where the model is coarse, and only the pieces of these need to be held against each other. */
#ifndef SURFACE_REPAIR_CROSSING_FACES_H
#define SURFACE_REPAIR_CROSSING_FACES_H
#include "surface/repair/parts.h"

#define CROSSING_CLEAR 0.05 /* of a part's reach: within one part, an edge crosses a face if both its ends are farther from its plane */

/* Returns, by model triangle, 1 where some edge within parts->solid's pieces of it may pass through another face, else 0. A face is told
   apart only where no rounding can matter: what is flagged need not cross. Within one part, faces that meet at a corner or along an edge
   alone do not cross. NULL: none does. The caller frees the array (mem_free). Thread: any. */
char *crossing_faces_find(const struct body_parts *parts);

#endif
