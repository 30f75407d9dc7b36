/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files that make a surface and measure on it. */
#ifndef SURFACE_SURFACE_IMPL_H
#define SURFACE_SURFACE_IMPL_H
#include "surface/mesh/bvh.h"
#include "surface/repair/repair.h"
#include "surface/surface.h"
#include "surface/geodesic/propagation.h"

struct stray { /* a vertex of the model whose triangles have no area: it takes the nearest place's distance */
    uint32_t vertex, points[3];
    double weights[3];
};

struct surface {
    struct log *log;
    struct workers *workers;
    size_t vertex_count;
    uint32_t *vertex_point; /* of the model's vertices */
    struct trimesh mesh;    /* welded, bridged, sampled; visible triangles first */
    struct trimesh visible; /* the same without the hidden ones; its arrays are the mesh's */
    uint32_t *component;    /* of its points, over visible triangles; NULL: read from a file, and not asked for yet */
    struct stray *strays;   /* by vertex */
    size_t stray_count;
    struct intrinsic intrinsic;
    struct propagation propagation;
    struct bvh *bvh;
    uint32_t *plane;                /* of the model's triangles: the lowest that it is not told apart from (decimate.h) */
    uint32_t *piece_first, *pieces; /* visible triangles by the plane of the model's triangle that they are a piece of */
    double edge_m;                  /* mean edge length */
    struct surface_report report;
    struct crack_bridge *bridges;
    size_t bridge_count, bridge_capacity;
};

/* Builds what searching and measuring need from mesh and intrinsic: the BVH, the propagation fans, and the lists of sampled triangles by
   model triangle. Builds the intrinsic triangulation too, unless it is there. */
void surface_index(struct surface *surface);

/* For bvh_nearest: only triangles whose front looks along the normal. */
struct surface_facing {
    const struct trimesh *mesh;
    const double *normal;
};
/* Predicate for bvh_nearest(): returns whether the triangle's front faces along the normal. facing: a struct surface_facing. */
bool surface_faces(const void *facing, uint32_t tri);

#endif
