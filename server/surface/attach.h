/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Joining a trimesh to itself: points become one, or a point is set into an edge or a face that it lies on. */
#ifndef SURFACE_ATTACH_H
#define SURFACE_ATTACH_H
#include "surface/trimesh.h"

struct attach {
    struct attach_item { /* point set into the edge a-b, at share t of the way from a; or into triangle tri (a = TRIMESH_NONE) */
        uint32_t point, a, b, tri;
        double t;
    } * items;
    struct attach_pair {
        uint32_t a, b;
    } * pairs, *joins; /* points that are one; that get an edge */
    size_t item_count, item_capacity, pair_count, pair_capacity, join_count, join_capacity;
    double longest_m;
};

void attach_init(struct attach *attach);
void attach_finish(struct attach *attach);
void attach_points(struct attach *attach, uint32_t a, uint32_t b, double distance_m);
void attach_to_edge(struct attach *attach, uint32_t point, uint32_t a, uint32_t b, double t, double distance_m);
void attach_to_tri(struct attach *attach, uint32_t point, uint32_t tri, double distance_m);
/* In each triangle that is cut up and has both points, there will be an edge between them. */
void attach_join(struct attach *attach, uint32_t a, uint32_t b);

/* Carries all of it out. target[point]: the point it has become. Triangles that touch a new place are cut up. */
void attach_apply(const struct attach *attach, struct trimesh *mesh, uint32_t *target);

#endif
