/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The mesh that subdivision works on: a geometry whose edges are cut at new vertices, and the triangles of one level at a time. Cuts are
   shared by all levels. */
#ifndef PREPROCESS_SUBDIVISION_SUBDIV_MESH_H
#define PREPROCESS_SUBDIVISION_SUBDIV_MESH_H
#include "base/mem.h"
#include "preprocess/levels/levels.h"
#include "preprocess/geometry/welded_positions.h"
#include "surface/mesh/trimesh.h"

struct subdiv_tri {
    uint32_t v[3], e[3];        /* e[i]: the edge from v[i] to v[i + 1] */
    uint32_t primitive, origin; /* of the level: its primitive; the triangle that this is a piece of, by its first index / 3 */
    bool good;                  /* it has been looked at */
    bool aimed;                 /* it has been looked at whether it is flat */
};

struct subdiv_edge {    /* between two places; all levels share them */
    uint32_t a, b;      /* vertices at its ends, one pair of several where normals or textures part */
    uint32_t origin[2]; /* of the level that it was first seen in: two triangles that it is part of; or TRIMESH_NONE */
    uint32_t middle;    /* the place where it is cut, or TRIMESH_NONE */
    uint32_t load;      /* the last level that it is cut in */
    uint32_t corner;    /* of triangles of the level in hand, the first that it begins at: 3 t + i; TRIMESH_NONE: none has it */
    float share;        /* of the way from place a to place b: where it is cut, or should be */
    float error;        /* of the field along it, if cutting may mend that; less than 0: not known yet */
    float barred;       /* of the field along it, if not */
    bool jumps;         /* likewise: because the distance jumps, not because it is short */
    bool unasked;       /* in the level in hand it is too short to be cut: what it errs by is not known */
    bool proven;        /* measured, and needs no cut; coarser levels ask for no more */
};

struct subdiv_list { /* of numbers of triangles, or of corners */
    uint32_t *at;
    size_t count, capacity;
    bool sorted; /* each once, the lowest first */
};

struct subdiv_mesh {
    struct geometry *geometry;
    struct welded_positions welded;
    size_t place_capacity, of_vertex_capacity, position_capacity, normal_capacity, texcoord_capacity, second_capacity, color_capacity;
    struct edge_table edges, vertex_edges; /* by places; by vertices */
    struct subdiv_edge *cuts;
    uint32_t *vertex_middles; /* by vertex edge */
    size_t cut_capacity, middle_capacity;
    uint32_t loads;          /* levels taken in hand so far */
    struct subdiv_tri *tris; /* of the level in hand */
    size_t tri_count, tri_capacity;
    uint32_t *next; /* of each corner: the next at its edge, or TRIMESH_NONE */
    size_t next_capacity;
    struct subdiv_list made; /* since the list was emptied */
    struct subdiv_list open; /* with edges that are cut, or that were when they were listed */
};

/* Builds the mesh over a geometry, to which vertices will be added. Returns false if out of memory; call subdiv_mesh_finish() in both
   cases. */
bool subdiv_mesh_init(struct subdiv_mesh *mesh, struct geometry *geometry);
/* Frees the mesh; the geometry stays. */
void subdiv_mesh_finish(struct subdiv_mesh *mesh);

/* Makes a level's triangles the current ones. */
void subdiv_mesh_load(struct subdiv_mesh *mesh, const struct level *level);
/* Writes the current triangles back to the level, primitive by primitive. */
void subdiv_mesh_store(const struct subdiv_mesh *mesh, struct level *level);

/* Returns whether this edge is cut in the current level. */
static inline bool subdiv_mesh_is_split(const struct subdiv_mesh *mesh, uint32_t edge) /* in the level in hand */
{
    return mesh->cuts[edge].load == mesh->loads;
}
/* Cuts an edge at its stored fraction, at position_m; triangles change only in subdiv_mesh_apply(). Returns true if the position is new
   (cuts[edge].middle), false if another level had cut the edge already. */
bool subdiv_mesh_split_edge(struct subdiv_mesh *mesh, uint32_t edge, const float position_m[3]);
/* Appends a number to a list. */
static inline void subdiv_mesh_list(struct subdiv_list *list, uint32_t number)
{
    list->sorted = list->count == 0 || (list->sorted && list->at[list->count - 1] < number);
    if (list->count == list->capacity)
        mem_grow(&list->at, &list->capacity, list->count + 1, sizeof(*list->at));
    list->at[list->count++] = number;
}
/* Sorts a list and removes duplicates. */
void subdiv_mesh_sort(struct subdiv_list *list);
/* Marks all triangles of the current level as new (mesh->made). */
void subdiv_mesh_list_all(struct subdiv_mesh *mesh);
/* Splits triangles until none has a cut edge. Returns the number of triangles made. */
size_t subdiv_mesh_apply(struct subdiv_mesh *mesh);
/* Inserts a vertex into a triangle at these barycentric weights. Returns the vertex. */
uint32_t subdiv_mesh_insert(struct subdiv_mesh *mesh, size_t tri, const double weights[3], const float position_m[3]);

/* Returns the edge between the other corners of two triangles at an edge, tris[1] having it the other way round; it need not be in the
   level. TRIMESH_NONE if the triangles do not share the edge's two vertices. */
uint32_t subdiv_mesh_opposite_edge(struct subdiv_mesh *mesh, const uint32_t tris[2], uint32_t edge);
/* Replaces the two triangles' common edge by that one, `across`. */
void subdiv_mesh_flip_edge(struct subdiv_mesh *mesh, const uint32_t tris[2], uint32_t edge, uint32_t across);

/* Writes the surface's normal at an edge, of no certain length. */
void subdiv_mesh_normal(const struct subdiv_mesh *mesh, const struct subdiv_edge *edge, double normal[3]);

#endif
