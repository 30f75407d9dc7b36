/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds interior triangles, which nobody sees from outside: those inside another, closed part, or covered by one. */
#ifndef SURFACE_REPAIR_INTERIOR_H
#define SURFACE_REPAIR_INTERIOR_H
#include "base/workers.h"
#include "surface/repair/parts.h"

enum interior_kind { INTERIOR_NOT, INTERIOR_INSIDE, INTERIOR_ACROSS };

/* Sets hidden[tri] to a value of enum interior_kind for each triangle whose centre is inside a closed part other than its own, decided by
   rays in five directions (at least four must agree). Where it lies on the other part's surface (within both parts' reach) it is interior
   if it is covered: the other part on one side, its own on the other. Within a thin part, where everything is within reach, also if it
   stands across, unless it alone connects visible triangles. In a part that intersects itself or has internal walls, where both sides are
   inside that part. part: of each triangle. crossings: points where a part intersects itself. workers may be NULL. Returns whether any is
   hidden. */
bool interior_find(const struct trimesh *mesh, const uint32_t *part, const struct body_parts *parts, const uint32_t *crossings,
                   size_t crossing_count, struct workers *workers, char *hidden);
/* Decides the triangles marked INTERIOR_ACROSS: those that alone connect visible pieces become visible, the others interior. */
void interior_resolve_across(const struct trimesh *mesh, char *hidden);
/* Hides small visible remnants amid hidden triangles: groups connected by points, touched by no other visible triangle, all of whose points
   touch hidden triangles larger than they. */
void interior_islands(const struct trimesh *mesh, char *hidden);

#endif
