/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds interior triangles, which are invisible from outside because they are inside another, closed part or covered by one. */
#ifndef SURFACE_REPAIR_INTERIOR_H
#define SURFACE_REPAIR_INTERIOR_H
#include "base/workers.h"
#include "surface/repair/parts.h"

enum interior_kind { INTERIOR_NOT, INTERIOR_INSIDE, INTERIOR_ACROSS };

/* Sets hidden[tri] to a value of enum interior_kind. Three kinds of triangles are interior. First: the triangle's centre is
   inside a closed part other than its own (four of five test rays must agree). Second: the triangle lies on another part's
   surface (within both parts' reach, parts.h), with that part on one side and its own part on the other, so it is covered from
   both sides. In a thin part, every point is within reach of the surface, so a triangle that stands across the part is interior
   too, unless it alone connects visible triangles. Third: in a part that intersects itself or has internal walls, the triangle
   has the part's inside on both sides. part: by triangle, its part. crossings: points where a part intersects itself. workers
   may be NULL. Returns whether any triangle is hidden. */
bool interior_find(const struct trimesh *mesh, const uint32_t *part, const struct body_parts *parts, const uint32_t *crossings,
                   size_t crossing_count, struct workers *workers, char *hidden);
/* Decides which triangles marked INTERIOR_ACROSS (standing across a thin part) become visible: groups that connect visible
 * pieces which nothing else connects. All others become interior. */
void interior_resolve_across(const struct trimesh *mesh, char *hidden);
/* Hides islands: groups of visible triangles connected by points. A group is an island if each of its points touches hidden
 * triangles, and these have a larger area than the group. */
void interior_islands(const struct trimesh *mesh, char *hidden);

#endif
