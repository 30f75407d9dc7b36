/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A batch of edits that join a mesh to itself: points to merge, points to insert into edges or faces, edges to add. Collected first, then
   applied at once. */
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

/* Starts an empty batch. */
void mesh_edit_init(struct mesh_edit *edit);
/* Frees the batch, without applying what is in it, and leaves it empty. */
void mesh_edit_finish(struct mesh_edit *edit);
/* Adds: points a and b, distance_m apart, become one. */
void mesh_edit_merge_points(struct mesh_edit *edit, uint32_t a, uint32_t b, double distance_m);
/* Adds: a point is inserted into the edge a-b at fraction t from a, distance_m away from it. */
void mesh_edit_insert_in_edge(struct mesh_edit *edit, uint32_t point, uint32_t a, uint32_t b, double t, double distance_m);
/* Adds: a point is inserted into a triangle, distance_m away from it. */
void mesh_edit_insert_in_tri(struct mesh_edit *edit, uint32_t point, uint32_t tri, double distance_m);
/* Adds: each triangle that is cut up and contains both points gets an edge between them. */
void mesh_edit_connect(struct mesh_edit *edit, uint32_t a, uint32_t b);

/* Applies the batch to the mesh: triangles that touch an inserted or merged point are triangulated anew. target[point]: receives the point
   that it has become. */
void mesh_edit_apply(const struct mesh_edit *edit, struct trimesh *mesh, uint32_t *target);

#endif
