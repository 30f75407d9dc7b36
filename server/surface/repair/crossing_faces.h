/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the faces of a model that may pass through others, before the surface is sampled: sampling cuts each face into pieces, dozens where
   the model is coarse, and only the pieces of these faces need to be tested against each other. */
#ifndef SURFACE_REPAIR_CROSSING_FACES_H
#define SURFACE_REPAIR_CROSSING_FACES_H
#include "surface/repair/parts.h"

/* as a fraction of a part's reach (parts.h): within one part, an edge crosses a face only if both of its ends are farther than this from
 * the face's plane */
#define CROSSING_CLEAR 0.05

/* Returns an array by model triangle: 1 if an edge within its pieces in parts->solid may pass through another face, else 0. Errors are on
   the safe side: flagged faces need not cross. Faces of one part that only share a corner or an edge do not cross. NULL: no face crosses.
   The caller frees the array (mem_free). Thread: any. */
char *crossing_faces_find(const struct body_parts *parts);

#endif
