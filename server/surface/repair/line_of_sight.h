/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the point of another body that a point faces. Mesh repair joins thin parts to the bodies that they face, even beyond
   the parts' reach (distance up to which a part counts as touching). The reach is only half of a thin part's thickness. */
#ifndef SURFACE_REPAIR_LINE_OF_SIGHT_H
#define SURFACE_REPAIR_LINE_OF_SIGHT_H
#include "surface/mesh/bvh.h"
#include "surface/repair/parts.h"

struct line_of_sight {
    const struct trimesh *mesh;
    const struct body_parts *parts;
    const uint32_t *body; /* per triangle of the mesh */
    const struct bvh *bvh;
    /* lists of the triangles at each point: those of a point are at[first[point]] to at[first[point + 1] - 1]. NULL: no part is
       thin, so none is searched beyond its reach (distance up to which it counts as touching) */
    uint32_t *first, *at;
};

/* Prepares the search. Keeps pointers to all arguments, which must outlive it unchanged: the search uses the mesh in its state before any
 * parts are joined. body: by triangle, its body. Free with line_of_sight_finish(). */
void line_of_sight_init(struct line_of_sight *sight, const struct trimesh *mesh, const struct body_parts *parts, const uint32_t *body,
                        const struct bvh *bvh);
/* Frees the lists. */
void line_of_sight_finish(struct line_of_sight *sight);

/* Finds the nearest point on a body other than `own`, within the tolerance, that `point` faces. A face at `point` must face the
 * found point, and the face found there must face `point`. The second condition keeps a thin sheet from being joined to the far
 * side of another. Faces of open parts face both ways; faces that bound no body face nothing. Returns false if there is no such
 * point. */
bool line_of_sight_find(const struct line_of_sight *sight, uint32_t point, uint32_t own, struct bvh_place *place);

#endif
