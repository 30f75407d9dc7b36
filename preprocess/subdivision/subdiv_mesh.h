/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The mesh that subdivision works on: a geometry whose edges are split at new vertices, and the triangles of one level at a
 * time. An edge is split at the same vertex in all levels. */
#ifndef PREPROCESS_SUBDIVISION_SUBDIV_MESH_H
#define PREPROCESS_SUBDIVISION_SUBDIV_MESH_H
#include "base/mem.h"
#include "preprocess/levels/levels.h"
#include "preprocess/geometry/welded_positions.h"
#include "surface/mesh/trimesh.h"

struct subdiv_tri {
    uint32_t v[3], e[3]; /* v: vertex at each corner; e[i]: edge from v[i] to v[i + 1] */
    /* primitive: index of its primitive in the level of detail; origin: index of the triangle before subdivision that contains it */
    uint32_t primitive, origin;
    bool good;  /* true: the error inside the triangle has been measured */
    bool aimed; /* true: the triangle has been checked for flatness (aim_at_corners()) */
};

struct subdiv_edge { /* an edge between two positions; shared by all levels of detail */
    /* vertices at the edge's ends; if several vertices share a position (with different normals or texture coordinates), any of these */
    uint32_t a, b;
    /* the level's triangles before subdivision that contain the edge, as indices; the second one is recorded only for edges of
     * the finest level. TRIMESH_NONE: none */
    uint32_t origin[2];
    uint32_t middle;    /* position index of the split point; TRIMESH_NONE: not split */
    uint32_t load;      /* number (count in mesh.loads) of the last level of detail that split the edge */
    /* head of the list of corners (3 * triangle + i) in the current level at which the edge begins, linked by mesh.next;
     * TRIMESH_NONE: no triangle of the level has the edge */
    uint32_t corner;
    float share;  /* split point, as a fraction of the way from a to b; for an edge not split yet, the best split point */
    /* largest error of linear interpolation along the edge that splitting can fix, as a share of the value range; below 0: not
       measured yet */
    float error;
    /* largest error of linear interpolation along the edge that splitting cannot fix (see jumps), share of the value range */
    float barred;
    bool jumps;   /* why the error is in `barred`: true: the distance jumps along the edge; false: the edge is too short */
    bool unasked; /* true: not measured, because the edge is too short to split in the current level of detail */
    bool proven;  /* true: measured; the edge needs no split in any level of detail, because coarser levels have looser limits */
};

struct subdiv_list { /* a list of triangle or corner indices */
    uint32_t *at;
    size_t count, capacity;
    bool sorted; /* true: the indices are in ascending order, without duplicates */
};

struct subdiv_mesh {
    struct geometry *geometry;
    struct welded_positions welded;
    size_t place_capacity, of_vertex_capacity, position_capacity, normal_capacity, texcoord_capacity, second_capacity, color_capacity;
    /* `edges` finds an edge by the position indices of its ends, `vertex_edges` by their vertex indices */
    struct edge_table edges, vertex_edges;
    struct subdiv_edge *cuts;
    uint32_t *vertex_middles; /* by index in vertex_edges: the vertex at the edge's split point */
    size_t cut_capacity, middle_capacity;
    uint32_t loads;          /* number of levels of detail loaded so far */
    struct subdiv_tri *tris; /* triangles of the level being subdivided */
    size_t tri_count, tri_capacity;
    uint32_t *next; /* by corner (3 * triangle + i): the next corner at which the same edge begins; TRIMESH_NONE: none */
    size_t next_capacity;
    struct subdiv_list made; /* indices of the triangles made by splits or flips since this list was last emptied */
    struct subdiv_list open; /* indices of the triangles that subdiv_mesh_apply() has yet to split */
};

/* Builds the mesh over a geometry, to which subdivision will add vertices. Returns false if out of memory. In either case, call
 * subdiv_mesh_finish(). */
bool subdiv_mesh_init(struct subdiv_mesh *mesh, struct geometry *geometry);
/* Frees the mesh, but not the geometry. */
void subdiv_mesh_finish(struct subdiv_mesh *mesh);

/* Makes the triangles of a level of detail the current ones. */
void subdiv_mesh_load(struct subdiv_mesh *mesh, const struct level *level);
/* Writes the current triangles back to their level of detail, primitive by primitive. */
void subdiv_mesh_store(const struct subdiv_mesh *mesh, struct level *level);

/* Returns whether the edge is split in the current level of detail. */
static inline bool subdiv_mesh_is_split(const struct subdiv_mesh *mesh, uint32_t edge)
{
    return mesh->cuts[edge].load == mesh->loads;
}
/* Splits an edge at its stored fraction (subdiv_edge.share). position_m: position of the split point. Triangles change only in
 * subdiv_mesh_apply(). Returns true if the position cuts[edge].middle is new; false if another level of detail had already
 * split the edge. */
bool subdiv_mesh_split_edge(struct subdiv_mesh *mesh, uint32_t edge, const float position_m[3]);
/* Appends a triangle or corner index to a list. */
static inline void subdiv_mesh_list(struct subdiv_list *list, uint32_t number)
{
    list->sorted = list->count == 0 || (list->sorted && list->at[list->count - 1] < number);
    if (list->count == list->capacity)
        mem_grow(&list->at, &list->capacity, list->count + 1, sizeof(*list->at));
    list->at[list->count++] = number;
}
/* Sorts a list of indices and removes duplicates. */
void subdiv_mesh_sort(struct subdiv_list *list);
/* Puts all triangles of the current level of detail on the list mesh->made, as if they were new. */
void subdiv_mesh_list_all(struct subdiv_mesh *mesh);
/* Splits all triangles of the current level of detail at their split edges, including edges split for another level. Returns
 * the number of triangles added. */
size_t subdiv_mesh_apply(struct subdiv_mesh *mesh);
/* Inserts a vertex into a triangle at these barycentric weights, dividing the triangle. Returns the vertex. */
uint32_t subdiv_mesh_insert(struct subdiv_mesh *mesh, size_t tri, const double weights[3], const float position_m[3]);

/* Returns the other diagonal of the two triangles at an edge: the edge between their opposite corners, which need not exist in
 * the level. The triangles must traverse the edge in opposite directions (equal winding). Returns TRIMESH_NONE if they do not
 * share the edge's two vertices. */
uint32_t subdiv_mesh_opposite_edge(struct subdiv_mesh *mesh, const uint32_t tris[2], uint32_t edge);
/* Flips the common edge of two triangles to the other diagonal, `across`. */
void subdiv_mesh_flip_edge(struct subdiv_mesh *mesh, const uint32_t tris[2], uint32_t edge, uint32_t across);

/* Writes the surface normal at an edge, not normalised. */
void subdiv_mesh_normal(const struct subdiv_mesh *mesh, const struct subdiv_edge *edge, double normal[3]);

#endif
