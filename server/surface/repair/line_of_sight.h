/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a point of one body sees of others: thin parts are joined to what they look at, farther than half their thickness. */
#ifndef SURFACE_REPAIR_LINE_OF_SIGHT_H
#define SURFACE_REPAIR_LINE_OF_SIGHT_H
#include "surface/mesh/bvh.h"
#include "surface/repair/parts.h"

struct line_of_sight {
    const struct trimesh *mesh;
    const struct parts *parts;
    const uint32_t *body; /* of its triangles */
    const struct bvh *bvh;
    uint32_t *first, *at; /* triangles at each point; NULL: no part is thin, and nothing is seen that is not within its reach */
};

/* All but the parts as they are before anything is joined; they must outlive it. */
void line_of_sight_init(struct line_of_sight *sight, const struct trimesh *mesh, const struct parts *parts, const uint32_t *body,
                        const struct bvh *bvh);
void line_of_sight_finish(struct line_of_sight *sight);

/* The nearest place of another body than `own`, the point's, that a face at the point looks at, and whose face looks back: within the
   tolerance. What is nearer than that to a thin sheet's far side would be joined through the sheet. Faces of open parts look both ways,
   those that bound nothing look nowhere. False: there is none. */
bool line_of_sight_find(const struct line_of_sight *sight, uint32_t point, uint32_t own, struct bvh_place *place);

#endif
