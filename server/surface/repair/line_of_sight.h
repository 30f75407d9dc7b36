/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds what a point of one body faces on other bodies. Thin parts are joined to what they face, beyond the half of their thickness that is
   their reach. */
#ifndef SURFACE_REPAIR_LINE_OF_SIGHT_H
#define SURFACE_REPAIR_LINE_OF_SIGHT_H
#include "surface/mesh/bvh.h"
#include "surface/repair/parts.h"

struct line_of_sight {
    const struct trimesh *mesh;
    const struct body_parts *parts;
    const uint32_t *body; /* of its triangles */
    const struct bvh *bvh;
    uint32_t *first, *at; /* triangles at each point; NULL: no part is thin, and nothing is seen that is not within its reach */
};

/* Prepares the search. Keeps pointers to everything passed, which must outlive it and must not change while it is used: it sees the mesh as
   it is before anything is joined. body: of each triangle. Free with line_of_sight_finish(). */
void line_of_sight_init(struct line_of_sight *sight, const struct trimesh *mesh, const struct body_parts *parts, const uint32_t *body,
                        const struct bvh *bvh);
/* Frees the lists. */
void line_of_sight_finish(struct line_of_sight *sight);

/* Finds the nearest place on a body other than the point's `own`, within the tolerance, that a face at the point looks at and whose face
   looks back: anything else would be joined through a thin sheet to its far side. Faces of open parts look both ways, those that bound
   nothing look nowhere. Returns false if there is none. */
bool line_of_sight_find(const struct line_of_sight *sight, uint32_t point, uint32_t own, struct bvh_place *place);

#endif
