/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Boxes around boxes around triangles: nearest place, and triangles whose boxes meet. Immutable once built. Thread: any. */
#ifndef SURFACE_MESH_BVH_H
#define SURFACE_MESH_BVH_H
#include <stdbool.h>

#include "surface/mesh/trimesh.h"

struct bvh;

struct bvh *bvh_create(const struct trimesh *mesh); /* mesh must outlive it, unchanged */
void bvh_destroy(struct bvh **bvh);

struct bvh_place {
    uint32_t tri;      /* TRIMESH_NONE: nothing within reach */
    double weights[3]; /* of its corners */
    double point[3], distance_m;
};
/* The nearest place within limit_m (may be INFINITY) on triangles for which allowed(arg, tri) holds; allowed may be NULL. */
void bvh_nearest(const struct bvh *bvh, const double point[3], double limit_m, bool (*allowed)(const void *arg, uint32_t tri),
                 const void *arg, struct bvh_place *place);

/* Whether there is such a place: quicker than which one is nearest. *tri: the triangle to be tried first, as near points often have theirs
   on the same one, or TRIMESH_NONE; then that on which there is one. */
bool bvh_any_within(const struct bvh *bvh, const double point[3], double limit_m, bool (*allowed)(const void *arg, uint32_t tri),
                    const void *arg, uint32_t *tri);

/* Calls visit(arg, tri) for every triangle whose box comes within margin_m of the box low..high. */
void bvh_overlaps(const struct bvh *bvh, const double low[3], const double high[3], double margin_m, void (*visit)(void *arg, uint32_t tri),
                  void *arg);

/* Calls visit(arg, tri, t) for every triangle that the ray from origin along direction meets, at origin + t direction, t > 0. No order. */
void bvh_ray(const struct bvh *bvh, const double origin[3], const double direction[3], void (*visit)(void *arg, uint32_t tri, double t),
             void *arg);

/* Where the line from p to q passes through the triangle: its share of the way (0..1) and the weights of the corners. False: nowhere. */
bool triangle_crossed(const double p[3], const double q[3], const double a[3], const double b[3], const double c[3], double *t,
                      double weights[3]);

/* The place of the triangle nearest to a point, as weights of its corners. */
void triangle_nearest(const double p[3], const double a[3], const double b[3], const double c[3], double weights[3]);
/* Its box or its plane alone is farther than that: a quick look. */
bool triangle_is_farther(const double p[3], const double a[3], const double b[3], const double c[3], double distance_m);

#endif
