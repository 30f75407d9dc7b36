/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Piecewise linear finite elements on an intrinsic triangulation: the cotangent Laplacian and lumped areas, as matrices for
 * CHOLMOD. With the edges of a Delaunay triangulation, no weight inside a patch (triangles connected by edges with two faces)
 * is negative. Call from any thread, each with a cholmod_common of its own. */
#ifndef SURFACE_GEODESIC_LAPLACIAN_H
#define SURFACE_GEODESIC_LAPLACIAN_H
#include <cholmod.h>

#include "surface/geodesic/intrinsic.h"

struct laplacian_slope { /* by triangle: gradients of the hat functions of its three corners in the triangle's plane, and its area */
    /* gradients in the triangle's plane: (x1, y1) of corner 1, (0, y2) of corner 2, minus the sum of both for corner 0. area:
       of the triangle */
    double x1, y1, y2, area;
};

struct laplacian {
    const struct intrinsic *in;
    uint32_t *row_of; /* by point: index of its row in the matrices; TRIMESH_NONE: the point has no triangle */
    size_t row_count;
    struct laplacian_slope *slopes; /* by triangle */
    double *mass_m2;                /* by row: a third of the area of all triangles at the row's point */
};

/* Assigns matrix rows to the points of `in`, and computes each triangle's slopes and each point's area (mass_m2) from the edge
 * lengths. `in` must outlive *laplacian. Returns false if out of memory; call laplacian_finish() in both cases. */
bool laplacian_init(struct laplacian *laplacian, const struct intrinsic *in);
/* Frees the arrays. */
void laplacian_finish(struct laplacian *laplacian);
/* Starts CHOLMOD with settings for factoring Laplacians: no printed messages, and AMD as the only ordering of the rows. BLAS
 * gets a single thread, since the workers use all cores. */
void laplacian_start(cholmod_common *common);
/* Returns the matrix diag(mass) + stiffness * L (L: cotangent Laplacian), stored as the lower triangle of a symmetric matrix. The caller
 * frees it. NULL: out of memory. */
cholmod_sparse *laplacian_assemble(const struct laplacian *laplacian, const double *mass, double stiffness, cholmod_common *common);

#endif
