/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Joining a trimesh to itself: points become one, or a point is set into an edge or a face that it lies on. */
#ifndef SURFACE_REPAIR_MESH_EDIT_H
#define SURFACE_REPAIR_MESH_EDIT_H
#include "surface/mesh/trimesh.h"

struct mesh_edit {
    struct mesh_edit_insertion { /* point set into the edge a-b, at share t of the way from a; or into triangle tri (a = TRIMESH_NONE) */
        uint32_t point, a, b, tri;
        double t;
    } * items;
    struct mesh_edit_pair {
        uint32_t a, b;
    } * pairs, *joins; /* points that are one; that get an edge */
    size_t item_count, item_capacity, pair_count, pair_capacity, join_count, join_capacity;
    double longest_m;
};

void mesh_edit_init(struct mesh_edit *edit);
void mesh_edit_finish(struct mesh_edit *edit);
void mesh_edit_merge_points(struct mesh_edit *edit, uint32_t a, uint32_t b, double distance_m);
void mesh_edit_insert_in_edge(struct mesh_edit *edit, uint32_t point, uint32_t a, uint32_t b, double t, double distance_m);
void mesh_edit_insert_in_tri(struct mesh_edit *edit, uint32_t point, uint32_t tri, double distance_m);
/* In each triangle that is cut up and has both points, there will be an edge between them. */
void mesh_edit_connect(struct mesh_edit *edit, uint32_t a, uint32_t b);

/* Carries all of it out. target[point]: the point it has become. Triangles that touch a new place are cut up. */
void mesh_edit_apply(const struct mesh_edit *edit, struct trimesh *mesh, uint32_t *target);

#endif
