/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Distances from a source, unfolded triangle by triangle (Novotni & Klein 2002): exact where the surface is flat or unrolls. */
#ifndef SURFACE_UNFOLD_H
#define SURFACE_UNFOLD_H
#include "surface/intrinsic.h"

struct unfold { /* what meets at each point; shared by all walks */
    const struct trimesh *mesh;
    const struct intrinsic *in;
    uint32_t *first;                        /* of each point in fans; one more at the end */
    struct unfold_fan {                     /* a triangle seen from one of its corners */
        uint32_t a, b;                      /* the others; the highest bit: the point itself may not be reached through this triangle */
        float to_a_m, to_b_m, cosine, sine; /* of the angle at the corner */
    } * fans;
    char *hidden;       /* of each point: it has no visible triangle */
    double steps_per_m; /* buckets of a walk */
    uint32_t bucket_count;
};
/* Visible triangles are walked over as the intrinsic triangulation has them, which leaves few obtuse ones; from there on the walk goes into
   the mesh's triangles from visible_count on, which are hidden inside another part, so that a triangle that passes through a surface has a
   distance at its hidden end too; but never back. mesh and in must outlive it. */
void unfold_init(struct unfold *unfold, const struct trimesh *mesh, size_t visible_count, const struct intrinsic *in);
void unfold_finish(struct unfold *unfold);

struct unfold_walk {    /* one thread's; zero-initialise, used again and again */
    double *distance_m; /* of all points; INFINITY where no way leads */
    char *settled;
    uint32_t *buckets;
    struct unfold_item {
        double distance_m;
        uint32_t point, next;
    } * items;
    uint64_t at; /* the bucket in hand */
    size_t item_count, item_capacity;
};
void unfold_walk_finish(struct unfold_walk *walk);

/* Distances of all points from the place with these weights on triangle tri. */
void unfold_from(const struct unfold *unfold, struct unfold_walk *walk, uint32_t tri, const double weights[3]);

/* The distance of c when a and b, on one edge, have theirs: the source is laid out in the plane of a, b and c, beyond the edge. */
double unfold_across(double da, double db, double ab, double ac, double bc);

#endif
