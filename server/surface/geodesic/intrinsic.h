/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The intrinsic Delaunay triangulation of a trimesh: edge lengths instead of places, edges flipped within patches until no edge has
   a negative cotangent weight (Bobenko & Springborn 2007; Fisher et al. 2007). Edges with one face, or more than two, stay. */
#ifndef SURFACE_GEODESIC_INTRINSIC_H
#define SURFACE_GEODESIC_INTRINSIC_H
#include "surface/mesh/trimesh.h"

struct intrinsic {
    size_t tri_count, point_count;
    uint32_t (*points)[3]; /* of each triangle, turned the same way throughout a patch */
    double (*lengths)[3];  /* side i: from corner i to corner i + 1 */
    uint32_t (*glue)[3];   /* 3 * triangle + side on the other side, TRIMESH_NONE: not flippable */
    size_t flips;
};

/* Builds the intrinsic Delaunay triangulation of a mesh by flipping edges. Finish with intrinsic_finish(). */
void intrinsic_init(struct intrinsic *in, const struct trimesh *mesh);
/* Frees the triangulation. */
void intrinsic_finish(struct intrinsic *in);

/* Lays a triangle with these side lengths out in the plane, corners at (0, 0), (l0, 0) and (x, y), and writes x and y. */
void intrinsic_layout(const double lengths[3], double *x, double *y);

#endif
