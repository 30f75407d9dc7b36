/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the point of another body that a point faces. Thin parts are joined to the bodies that they face, also beyond their reach, which is
 * only half of their thickness. */
#ifndef SURFACE_REPAIR_LINE_OF_SIGHT_H
#define SURFACE_REPAIR_LINE_OF_SIGHT_H
#include "surface/mesh/bvh.h"
#include "surface/repair/parts.h"

struct line_of_sight {
    const struct trimesh *mesh;
    const struct body_parts *parts;
    const uint32_t *body; /* per triangle of the mesh */
    const struct bvh *bvh;
    uint32_t *first, *at; /* by point: its triangles; NULL: no part is thin, so no search beyond the reach is needed */
};

/* Prepares the search. Keeps pointers to all arguments, which must outlive it unchanged: the search uses the mesh as it is before anything
   is joined. body: per triangle. Free with line_of_sight_finish(). */
void line_of_sight_init(struct line_of_sight *sight, const struct trimesh *mesh, const struct body_parts *parts, const uint32_t *body,
                        const struct bvh *bvh);
/* Frees the lists. */
void line_of_sight_finish(struct line_of_sight *sight);

/* Finds the nearest point on a body other than `own`, within the tolerance, such that a face at `point` faces it and the found face looks
 * back; without this condition a thin sheet would be joined to the far side of another. Faces of open parts look both ways; faces that
 * bound no body face nothing. Returns false if there is none. */
bool line_of_sight_find(const struct line_of_sight *sight, uint32_t point, uint32_t own, struct bvh_place *place);

#endif
