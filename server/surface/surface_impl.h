/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Declarations shared by the files that build a surface and compute distances on it. */
#ifndef SURFACE_SURFACE_IMPL_H
#define SURFACE_SURFACE_IMPL_H
#include "surface/mesh/bvh.h"
#include "surface/repair/repair.h"
#include "surface/surface.h"
#include "surface/geodesic/propagation.h"

/* Stray vertex: a model vertex without a point of the surface, because all its triangles have no area, or it was merged with another
   (short_sides.h). Its distances are those of the nearest surface point. */
struct stray {
    uint32_t vertex, tri; /* tri: visible triangle of the nearest surface point */
    double point_m[3];
};

struct surface {
    struct log *log;
    struct workers *workers;
    size_t vertex_count;
    uint32_t *vertex_point; /* per model vertex */
    struct trimesh mesh;    /* mesh after welding, bridging of gaps and sampling; visible triangles first */
    struct trimesh visible; /* mesh of the visible triangles only; shares the arrays of `mesh` */
    /* by point: its connected component, by visible triangles; NULL: not computed yet, because the surface was read from a file */
    uint32_t *component;
    struct stray *strays; /* sorted by vertex */
    size_t stray_count;
    struct intrinsic intrinsic;
    struct propagation propagation;
    struct bvh *bvh;
    uint32_t *plane; /* by model triangle: lowest index of the coplanar model triangles merged with it (decimate.h) */
    /* pieces: visible triangles, grouped by `plane` of their model triangle; piece_first: by plane, index in `pieces` of its first
       triangle */
    uint32_t *piece_first, *pieces;
    double edge_m;                  /* mean edge length */
    struct surface_report report;
    struct crack_bridge *bridges;
    size_t bridge_count, bridge_capacity;
};

/* Builds the data for searches and distances: the bounding volume hierarchy, the propagation fans (neighbours around each
 * point), and the lists of triangles by model triangle. Also builds the intrinsic triangulation if the stored surface had none.
 * */
void surface_index(struct surface *surface);

/* Argument of surface_faces(), which accepts only triangles whose front faces along `normal`. */
struct surface_facing {
    const struct trimesh *mesh;
    const double *normal;
};
/* Predicate for bvh_nearest(): returns whether the triangle's front faces along the normal. facing: a struct surface_facing. */
bool surface_faces(const void *facing, uint32_t tri);

#endif
