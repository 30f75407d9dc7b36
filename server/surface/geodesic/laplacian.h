/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Piecewise linear finite elements on an intrinsic triangulation: the cotangent Laplacian and lumped areas, as matrices for CHOLMOD. With
   the edges of a Delaunay triangulation no weight inside a patch is negative. Thread: any, each with a cholmod_common of its own. */
#ifndef SURFACE_GEODESIC_LAPLACIAN_H
#define SURFACE_GEODESIC_LAPLACIAN_H
#include <cholmod.h>

#include "surface/geodesic/intrinsic.h"

struct laplacian_slope { /* gradients of the three hat functions in the triangle's plane, and its area */
    /* gradient of the hat function of corner 1: (x1, y1); of corner 2: (0, y2); of corner 0: minus the sum of both; area: triangle */
    double x1, y1, y2, area;
};

struct laplacian {
    const struct intrinsic *in;
    uint32_t *row_of; /* row of each point in the matrices; TRIMESH_NONE: the point has no triangle */
    size_t row_count;
    struct laplacian_slope *slopes; /* by triangle */
    double *mass_m2;                /* mass of each row: a third of the area of all triangles at the point */
};

/* Numbers the rows and measures the triangles of `in`, which must outlive it. Returns false if out of memory; call laplacian_finish() in
   both cases. */
bool laplacian_init(struct laplacian *laplacian, const struct intrinsic *in);
/* Frees the arrays. */
void laplacian_finish(struct laplacian *laplacian);
/* Starts CHOLMOD for factoring such matrices: no output, one ordering, and single-threaded BLAS, since the workers use all cores. */
void laplacian_start(cholmod_common *common);
/* Returns diag(mass) + stiffness * L, the lower triangle of a symmetric matrix, which the caller frees; NULL if out of memory. */
cholmod_sparse *laplacian_assemble(const struct laplacian *laplacian, const double *mass, double stiffness, cholmod_common *common);

#endif
