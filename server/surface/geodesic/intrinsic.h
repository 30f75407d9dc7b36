/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Intrinsic Delaunay triangulation of a mesh, which has edge lengths instead of positions. Edges are flipped within patches
 * (triangles connected by edges with two faces) until no cotangent weight is negative (Bobenko & Springborn 2007; Fisher et al.
 * 2007). Edges with one face, or more than two, are never flipped. */
#ifndef SURFACE_GEODESIC_INTRINSIC_H
#define SURFACE_GEODESIC_INTRINSIC_H
#include "surface/mesh/trimesh.h"

struct intrinsic {
    size_t tri_count, point_count;
    /* by triangle: indices of its three points; all triangles of a patch (connected by edges with two faces) have the same orientation */
    uint32_t (*points)[3];
    double (*lengths)[3]; /* by triangle: length of side i, which leads from corner i to corner i + 1 */
    /* by triangle and side: the adjacent triangle's side, as 3 * triangle + side; TRIMESH_NONE: no adjacent triangle across which the edge
     * could be flipped */
    uint32_t (*glue)[3];
    size_t flips;
    /* length (m) by which all sides were made longer, so that no triangle is flat (intrinsic.c, mollify) */
    double lengthened_m;
};

/* Builds the intrinsic Delaunay triangulation of a mesh by flipping edges. Finish with intrinsic_finish(). */
void intrinsic_init(struct intrinsic *in, const struct trimesh *mesh);
/* Frees the triangulation. */
void intrinsic_finish(struct intrinsic *in);

/* Places a triangle with the side lengths l0, l1, l2 in the plane: corners 0 and 1 at (0, 0) and (l0, 0). Writes the position (x,
   y) of corner 2. */
void intrinsic_layout(const double lengths[3], double *x, double *y);

#endif
