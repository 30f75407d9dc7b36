/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Distances around a source, unfolded triangle by triangle (Novotni & Klein 2002): exact where the surface is flat or unrolls. */
#ifndef SURFACE_LOCAL_H
#define SURFACE_LOCAL_H
#include "surface/trimesh.h"

struct local { /* which triangles meet at a point; shared by all walks */
    const struct trimesh *mesh;
    size_t visible_count; /* the first so many triangles are outside; the others are hidden inside another part */
    uint32_t *first, *tris;
    char *hidden; /* of each point: it has no visible triangle */
};
/* Walks go over visible triangles; from there on into hidden ones, so that a triangle that passes through a surface has a distance at its
   hidden end too, but never back. mesh must outlive it. */
void local_init(struct local *local, const struct trimesh *mesh, size_t visible_count);
void local_finish(struct local *local);

struct local_walk {     /* one thread's; zero-initialise, used again and again */
    double *distance_m; /* of all points; INFINITY where not reached */
    struct local_item {
        double distance_m;
        uint32_t point;
    } * heap;
    uint32_t *reached; /* points with a finite distance */
    char *settled;
    size_t reached_count, reached_capacity, heap_count, heap_capacity;
};
void local_walk_finish(struct local_walk *walk);

/* Distances up to limit_m from the place with these weights on triangle tri. Clears what the last walk left. */
void local_from(const struct local *local, struct local_walk *walk, uint32_t tri, const double weights[3], double limit_m);

/* The distance of c when a and b, on one edge, have theirs: the source is laid out in the plane of a, b and c, beyond the edge. */
double local_unfold(double da, double db, double ab, double ac, double bc);

#endif
