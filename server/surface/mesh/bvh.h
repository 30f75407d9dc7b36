/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bounding volume hierarchy over a mesh's triangles: nearest-point, overlap and ray queries. Immutable once built. Call from any thread. */
#ifndef SURFACE_MESH_BVH_H
#define SURFACE_MESH_BVH_H
#include <stdbool.h>

#include "surface/mesh/trimesh.h"

struct bvh;

/* Builds the hierarchy of a mesh. The mesh must outlive the hierarchy and stay unchanged. The caller destroys the hierarchy. */
struct bvh *bvh_create(const struct trimesh *mesh);
/* Frees the hierarchy and sets *bvh to NULL. *bvh may be NULL. */
void bvh_destroy(struct bvh **bvh);

struct bvh_place {
    uint32_t tri;      /* TRIMESH_NONE: nothing within the limit */
    double weights[3]; /* of the triangle's corners */
    double point[3], distance_m;
};
/* Finds the point of the mesh nearest to `point` within limit_m (may be INFINITY), on triangles for which allowed(arg, tri) returns true
 * (NULL: all). place->tri is TRIMESH_NONE if there is no such point. */
void bvh_nearest(const struct bvh *bvh, const double point[3], double limit_m, bool (*allowed)(const void *arg, uint32_t tri),
                 const void *arg, struct bvh_place *place);

/* Sets a number (label) for each triangle of the mesh, for bvh_nearest_unlike(). The array `label` must outlive the hierarchy. */
void bvh_set_labels(struct bvh *bvh, const uint32_t *label);
/* Finds the nearest point, like bvh_nearest(), on triangles whose label (bvh_set_labels) differs from `label`. Skips nodes
   whose triangles all have this label. */
void bvh_nearest_unlike(const struct bvh *bvh, const double point[3], double limit_m, uint32_t label,
                        bool (*allowed)(const void *arg, uint32_t tri), const void *arg, struct bvh_place *place);

/* Returns whether a triangle for which allowed() is true has a point within limit_m of `point`; faster than finding the nearest
   point. *tri: triangle to try first, or TRIMESH_NONE (neighbouring points often have the same nearest triangle); receives the
   triangle that was found. */
bool bvh_any_within(const struct bvh *bvh, const double point[3], double limit_m, bool (*allowed)(const void *arg, uint32_t tri),
                    const void *arg, uint32_t *tri);

/* Calls visit(arg, tri) for every triangle whose bounding box comes within margin_m of the box low..high. */
void bvh_overlaps(const struct bvh *bvh, const double low[3], const double high[3], double margin_m, void (*visit)(void *arg, uint32_t tri),
                  void *arg);

/* Calls visit(arg, tri, t), in no particular order, for every triangle that the ray hits at origin + t * direction with t > 0. */
void bvh_ray(const struct bvh *bvh, const double origin[3], const double direction[3], void (*visit)(void *arg, uint32_t tri, double t),
             void *arg);

/* Computes where the segment from p to q passes through a triangle: the fraction t (0 at p, 1 at q) and the barycentric weights. Returns
 * false if the segment misses the triangle, or is parallel to it within rounding. */
bool triangle_crossed(const double p[3], const double q[3], const double a[3], const double b[3], const double c[3], double *t,
                      double weights[3]);

/* Computes the point of a triangle nearest to p, as barycentric weights. */
void triangle_nearest(const double p[3], const double a[3], const double b[3], const double c[3], double weights[3]);
/* Returns true only if the triangle is farther from p than distance_m, judged by its bounding box or plane alone. A quick rejection test:
 * false does not mean that the triangle is near. */
bool triangle_is_farther(const double p[3], const double a[3], const double b[3], const double c[3], double distance_m);

#endif
