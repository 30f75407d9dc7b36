/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A batch of edits with which mesh repair joins parts of one mesh: points to merge, points to insert into edges or faces, edges
   to add. Edits are collected first, and mesh_edit_apply() applies them together. */
#ifndef SURFACE_REPAIR_MESH_EDIT_H
#define SURFACE_REPAIR_MESH_EDIT_H
#include "surface/mesh/trimesh.h"

struct mesh_edit {
    /* point to insert: into the edge a-b at the fraction t from a, or, if a is TRIMESH_NONE, into the triangle tri */
    struct mesh_edit_insertion {
        uint32_t point, a, b, tri;
        double t;
    } * items;
    struct mesh_edit_pair {
        uint32_t a, b;
    } * pairs, *joins; /* pairs: pairs of points to merge; joins: pairs of points to connect by an edge */
    size_t item_count, item_capacity, pair_count, pair_capacity, join_count, join_capacity;
    double longest_m;
};

/* Starts an empty batch. */
void mesh_edit_init(struct mesh_edit *edit);
/* Frees the batch without applying it, and leaves it empty. */
void mesh_edit_finish(struct mesh_edit *edit);
/* Requests that points a and b, which are distance_m apart, be merged. */
void mesh_edit_merge_points(struct mesh_edit *edit, uint32_t a, uint32_t b, double distance_m);
/* Requests that a point, distance_m away from the edge a-b, be inserted into this edge at fraction t from a. */
void mesh_edit_insert_in_edge(struct mesh_edit *edit, uint32_t point, uint32_t a, uint32_t b, double t, double distance_m);
/* Requests that a point, distance_m away from the triangle, be inserted into the triangle. */
void mesh_edit_insert_in_tri(struct mesh_edit *edit, uint32_t point, uint32_t tri, double distance_m);
/* Requests an edge between the two points, in each edited triangle that contains both. */
void mesh_edit_connect(struct mesh_edit *edit, uint32_t a, uint32_t b);

/* Applies the batch to the mesh: triangles with an inserted or merged point are triangulated again. target[point] receives the point's new
 * index. */
void mesh_edit_apply(const struct mesh_edit *edit, struct trimesh *mesh, uint32_t *target);

#endif
