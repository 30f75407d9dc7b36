/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Triangles that nobody sees from outside: those inside another, closed part, or covered by one. */
#ifndef SURFACE_REPAIR_INTERIOR_H
#define SURFACE_REPAIR_INTERIOR_H
#include "base/workers.h"
#include "surface/repair/parts.h"

enum interior_kind { INTERIOR_NOT, INTERIOR_INSIDE, INTERIOR_ACROSS };

/* hidden[tri] = 1 where the middle of the triangle is inside a closed part other than its own: rays into five directions say so, four at
   least. Where it lies on the other part's surface (within both parts' reach), it is hidden if it is covered: the other part is
   on one side of it and its own on the other. Within a thin part, where all is within reach, also if it stands across, unless it alone
   joins what is seen. In a part that passes through itself, or has walls within, where both sides are inside that part.
   part: of mesh's triangles. crossings: points where a part passes through itself. workers may be NULL. */
void interior_find(const struct trimesh *mesh, const uint32_t *part, const struct parts *parts, const uint32_t *crossings,
                   size_t crossing_count, struct workers *workers, char *hidden);
/* Of triangles that are INTERIOR_ACROSS, those are seen after all by which pieces hang together that else would not; others are inside. */
void interior_resolve_across(const struct trimesh *mesh, char *hidden);
/* Hides what is left over amid hidden triangles: pieces that hang together by points with nothing else that is seen, all of whose points
   touch hidden triangles, and which are smaller than those. */
void interior_islands(const struct trimesh *mesh, char *hidden);

#endif
