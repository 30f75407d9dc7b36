/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Geodesic distances by propagation from a source, triangle by triangle, nearest points first. Each triangle is unfolded into
 * the plane, where shortest paths are straight lines (Novotni and Klein 2002). Exact where the surface is flat or developable.
 * */
#ifndef SURFACE_GEODESIC_PROPAGATION_H
#define SURFACE_GEODESIC_PROPAGATION_H
#include "surface/geodesic/intrinsic.h"

#define PROPAGATION_FAN 8 /* number of neighbours of a point that are processed together, one per lane of a vector register */
/* bend_radius_m of a point at which paths do not bend, or bend in an unknown way */
#define PROPAGATION_NO_BEND 1e30f

/* Data about a mesh that all propagations share: around each point, its neighbours and triangles in angular order (fans). */
struct propagation {
    const struct trimesh *mesh;
    const struct intrinsic *in;
    /* by point: index in `fans` of its first fan (neighbours of the point in angular order); one additional element at the end */
    uint32_t *first;
    /* up to PROPAGATION_FAN neighbours of a point in angular order, and the triangles between consecutive neighbours */
    struct propagation_fan {
        /* by lane (element of a vector register): point index of the neighbour; in unused lanes, index of the point whose fan
           this is */
        uint32_t to[PROPAGATION_FAN];
        /* length of the edge to the neighbour in metres. Negative: the length, but the neighbour must get no distance from this
           point. INFINITY: unused lane */
        float length_m[PROPAGATION_FAN];
        /* cosine and sine of the angle to the next neighbour; sine 0: no triangle in between */
        float cosine[PROPAGATION_FAN], sine[PROPAGATION_FAN];
    } * fans;
    size_t fan_count, fan_capacity;
    char *hidden;      /* by point: 1 if the point belongs to no visible triangle */
    /* by point: radius in metres of the arc around which shortest paths bend there, around a hole or a saddle; 0: at a corner;
       PROPAGATION_NO_BEND: not at all */
    float *bend_radius_m;
    float steps_per_m; /* number of buckets of the priority queue per metre of distance */
    double near_m;     /* distance from the source up to which points get exact distances, along straight lines on the unfolded surface */
    uint32_t bucket_count;
};
/* Builds the fans (neighbours and triangles around each point). Visible triangles (the first visible_count) are used in their intrinsic
   Delaunay form, which has few obtuse ones. Propagation continues from visible into interior (hidden) triangles, so that a triangle that
   passes through a surface also has distances at its hidden end. It never returns from interior to visible triangles. mesh and in must
   outlive the propagation. Free with propagation_finish(). */
void propagation_init(struct propagation *propagation, const struct trimesh *mesh, size_t visible_count, const struct intrinsic *in);
/* Frees the fans. */
void propagation_finish(struct propagation *propagation);

/* State of one propagation (from one source), used by one thread. Initialise with zeros; may be reused for further sources. */
struct propagation_front {
    float *distance_m; /* per point; INFINITY: not reached */
    /* per point: distance from the source to the last point at which the path bends, around a hole or a saddle; 0: the path is
       straight on the unfolded surface */
    float *bend_m;
    /* by point: straight-line distance in metres from the source of the propagation, a lower bound of the geodesic distance */
    float *straight_m;
    char *state; /* by point: WAITING, SETTLED or CORRECTED (propagation_front.c) */
    uint32_t *buckets;
    struct propagation_item {
        uint32_t point, next;
    } * items;
    uint64_t at; /* number of the current bucket */
    double source_m[3];
    size_t item_count, item_capacity;
};
/* Frees the state. */
void propagation_front_finish(struct propagation_front *front);

#define PROPAGATION_ABREAST 2 /* maximum number of sources that one thread propagates alternately, to hide memory latency */
struct propagation_source {
    uint32_t tri;
    const double *weights; /* of the triangle's corners */
};
/* Computes the distances of all points from each of `count` sources (at most PROPAGATION_ABREAST). fronts[i] holds the state
 * for source i. Results do not depend on which sources are computed together. Returns false when out of memory. Call from any
 * thread, with its own fronts. */
bool propagation_run(const struct propagation *propagation, struct propagation_front *fronts, const struct propagation_source *sources,
                     size_t count);

#endif
