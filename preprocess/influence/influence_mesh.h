/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The surface between sensors, for finite elements: the sampled surface with smaller triangles around each sensor, so that a disc of the
   sensor's size holds some of its points. Thread: one, unless constant. */
#ifndef PREPROCESS_INFLUENCE_INFLUENCE_MESH_H
#define PREPROCESS_INFLUENCE_INFLUENCE_MESH_H
#include "surface/geodesic/intrinsic.h"
#include "surface/surface.h"
#include "surface/vertex_embedding.h"

struct influence_disc { /* the points that a sensor touches, by how much of their area it does; the shares add up to 1 */
    uint32_t *points;
    double *shares;
    size_t count;
};

struct influence_mesh {
    struct trimesh mesh; /* tri_source: the surface's visible triangle that it is a piece of */
    struct intrinsic intrinsic;
    double (*sources_m)[3]; /* of the sensors, on the surface */
    uint32_t *source_tris;
    size_t source_count;
    double size_m;                  /* diagonal of the surface's main part */
    double longest_m;               /* of the edges */
    uint32_t *piece_first, *pieces; /* triangles by tri_source */
    uint32_t *fan_first, *fans;     /* triangles by point */
    struct influence_disc *discs;   /* by sensor */
};

/* Builds the mesh for sensors that stand nearest to places_m, each a disc of radius_m. Edges are halved until none is longer than edge_m
   (INFINITY: away from sensors they are left as they are), or there are too many; then mesh->longest_m says how long. Returns false if out
   of memory; call influence_mesh_finish() in both cases. */
bool influence_mesh_init(struct influence_mesh *mesh, const struct surface *surface, const double (*places_m)[3], size_t count,
                         double radius_m, double edge_m);
/* Frees the mesh. */
void influence_mesh_finish(struct influence_mesh *mesh);

/* Where a vertex of an asset file is on the mesh: its value is the sum of weights times the values of three points. */
struct influence_anchor {
    uint32_t points[3];
    float weights[3];
};
/* Writes the anchor of a place on the surface. */
void influence_mesh_anchor(const struct influence_mesh *mesh, const struct surface_point *place, struct influence_anchor *out);
/* Writes the anchor of each of `count` vertices of the embedding, which is on the same surface. */
void influence_mesh_anchors(const struct influence_mesh *mesh, const struct vertex_embedding *embedding, size_t count,
                            struct influence_anchor *out);

#endif
