/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Geodesic distances by propagation from a source, triangle by triangle, nearer points first, each triangle unfolded into the plane
   (Novotni and Klein 2002): exact where the surface is flat or developable. */
#ifndef SURFACE_GEODESIC_PROPAGATION_H
#define SURFACE_GEODESIC_PROPAGATION_H
#include "surface/geodesic/intrinsic.h"

#define PROPAGATION_FAN 8 /* points around one that are looked at side by side, a lane of a vector register each */

/* What propagation needs to know of a mesh, shared by all runs: the fans of triangles around each point. */
struct propagation {
    const struct trimesh *mesh;
    const struct intrinsic *in;
    uint32_t *first;                     /* of each point in fans; one more at the end */
    struct propagation_fan {             /* seen from a point, others in order, and the triangle between each and the next */
        uint32_t to[PROPAGATION_FAN];    /* the point itself where there is no more */
        float length_m[PROPAGATION_FAN]; /* < 0: not to be reached through these triangles; INFINITY: none */
        float cosine[PROPAGATION_FAN], sine[PROPAGATION_FAN]; /* of the angle to the next; sine 0: no triangle in between */
    } * fans;
    size_t fan_count, fan_capacity;
    char *hidden;      /* of each point: it has no visible triangle */
    float steps_per_m; /* buckets of a front */
    double near_m;     /* so far points are looked for straight from the source */
    uint32_t bucket_count;
};
/* Builds the fans. Visible triangles (the first visible_count) are crossed as the intrinsic triangulation has them, which leaves few obtuse
   ones; from them propagation enters the mesh's interior triangles, so that one that passes through a surface has distances at its interior
   end too, but never returns. mesh and in must outlive it. Free with propagation_finish(). */
void propagation_init(struct propagation *propagation, const struct trimesh *mesh, size_t visible_count, const struct intrinsic *in);
/* Frees the fans. */
void propagation_finish(struct propagation *propagation);

/* The state of one propagation, of one thread; zero-initialise, and use again and again. */
struct propagation_front {
    float *distance_m;     /* of all points; INFINITY where no way leads */
    float *straight_m;     /* and as the crow flies */
    char *settled;
    uint32_t *buckets;
    struct propagation_item {
        uint32_t point, next;
    } * items;
    uint64_t at; /* the bucket in hand */
    double source_m[3];
    size_t item_count, item_capacity;
};
/* Frees the state. */
void propagation_front_finish(struct propagation_front *front);

#define PROPAGATION_ABREAST 2 /* fronts that one thread takes at once, at most: it waits less for each */
struct propagation_source {
    uint32_t tri;
    const double *weights; /* of its corners */
};
/* Computes the distances of all points from each of `count` sources (at most PROPAGATION_ABREAST), into the front of the same number.
   Results do not depend on which sources run together. Returns false if out of memory. Thread: any, with fronts of its own. */
bool propagation_run(const struct propagation *propagation, struct propagation_front *fronts, const struct propagation_source *sources,
                     size_t count);

#endif
