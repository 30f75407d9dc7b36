/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The finite-element mesh on which sensors' weights are computed: the surface's triangles, refined around each sensor so that a
 * disc of the sensor's size contains some mesh points. Call from one thread only; any for reading a const mesh. */
#ifndef PREPROCESS_INFLUENCE_INFLUENCE_MESH_H
#define PREPROCESS_INFLUENCE_INFLUENCE_MESH_H
#include "surface/geodesic/intrinsic.h"
#include "surface/surface.h"
#include "surface/vertex_embedding.h"

/* the mesh points under a sensor's disc; shares: each point's fraction of the disc's area; they sum to 1 */
struct influence_disc {
    uint32_t *points;
    double *shares;
    size_t count;
};

struct influence_mesh {
    struct trimesh mesh; /* mesh.tri_source[mesh triangle]: the visible surface triangle that contains it */
    struct intrinsic intrinsic;
    double (*sources_m)[3]; /* the sensors' positions projected onto the surface */
    uint32_t *source_tris;
    size_t source_count;
    double size_m;                  /* length of the diagonal of the surface's main part (base/math/gap_split.h), metres */
    double longest_m;               /* length of the mesh's longest edge, metres */
    uint32_t *piece_first, *pieces; /* mesh triangles, grouped by the visible surface triangle that contains them (tri_source) */
    uint32_t *fan_first, *fans;     /* mesh triangles, grouped by their points */
    struct influence_disc *discs;   /* disc of each sensor */
};

/* Builds the mesh for `count` sensors, each a disc of radius_m at the surface point nearest to its places_m. Splits edges in
 * half until none is longer than edge_m or the point limit is reached; mesh->longest_m receives the longest edge. With edge_m
 * INFINITY, only edges near sensors are split. Returns false if out of memory. In either case, call influence_mesh_finish(). */
bool influence_mesh_init(struct influence_mesh *mesh, const struct surface *surface, const double (*places_m)[3], size_t count,
                         double radius_m, double edge_m);
/* Frees the mesh. */
void influence_mesh_finish(struct influence_mesh *mesh);

/* Position of an asset file's vertex on the mesh. The vertex's value is the weighted sum of the values at three mesh points. */
struct influence_anchor {
    uint32_t points[3];
    float weights[3];
};
/* Writes the anchor (three mesh points and their weights) of a position on the surface. */
void influence_mesh_anchor(const struct influence_mesh *mesh, const struct surface_point *place, struct influence_anchor *out);
/* Writes the anchors of `count` vertices. embedding: the vertices' positions on the surface that the mesh was made from. */
void influence_mesh_anchors(const struct influence_mesh *mesh, const struct vertex_embedding *embedding, size_t count,
                            struct influence_anchor *out);

#endif
