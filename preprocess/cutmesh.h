/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A geometry whose edges are being cut: new places, new vertices at them, and the triangles of one level. */
#ifndef PREPROCESS_CUTMESH_H
#define PREPROCESS_CUTMESH_H
#include "preprocess/levels.h"
#include "preprocess/places.h"
#include "surface/trimesh.h"

struct cut_tri {
    uint32_t v[3], e[3];        /* e[i]: the edge from v[i] to v[i + 1] */
    uint32_t primitive, origin; /* of the level: its primitive; the triangle that this is a piece of, by its first index / 3 */
    bool good;                  /* it has been looked at */
    bool aimed;                 /* it has been looked at whether it is flat */
};

struct cut_edge {       /* between two places; all levels share them */
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

struct cut_list { /* of numbers of triangles, or of corners */
    uint32_t *at;
    size_t count, capacity;
    bool sorted; /* each once, the lowest first */
};

struct cutmesh {
    struct geometry *geometry;
    struct places places;
    uint32_t own_vertices; /* of the geometry, before anything was added */
    size_t place_capacity, of_vertex_capacity, position_capacity, normal_capacity, texcoord_capacity, second_capacity, color_capacity;
    struct edge_table edges, vertex_edges; /* by places; by vertices */
    struct cut_edge *cuts;
    uint32_t *vertex_middles; /* by vertex edge */
    size_t cut_capacity, middle_capacity;
    uint32_t loads;       /* levels taken in hand so far */
    struct cut_tri *tris; /* of the level in hand */
    size_t tri_count, tri_capacity;
    uint32_t *next; /* of each corner: the next at its edge, or TRIMESH_NONE */
    size_t next_capacity;
    struct cut_list made; /* since the list was emptied */
    struct cut_list open; /* with edges that are cut, or that were when they were listed */
};

bool cutmesh_init(struct cutmesh *mesh, struct geometry *geometry); /* false: out of memory; finish copes */
void cutmesh_finish(struct cutmesh *mesh);

/* Takes a level's triangles in hand; gives them back, primitive by primitive. */
void cutmesh_load(struct cutmesh *mesh, const struct level *level);
void cutmesh_store(const struct cutmesh *mesh, struct level *level);

static inline bool cutmesh_is_cut(const struct cutmesh *mesh, uint32_t edge) /* in the level in hand */
{
    return mesh->cuts[edge].load == mesh->loads;
}
/* Cuts an edge at its share of the way; the triangles stay as they are until cutmesh_apply. True: at a new place
   (cuts[edge].middle). False: where another level cut it. */
bool cutmesh_cut(struct cutmesh *mesh, uint32_t edge, const float position_m[3]);
void cutmesh_list(struct cut_list *list, uint32_t number);
/* The list in order, each once. */
void cutmesh_sort(struct cut_list *list);
/* Has all triangles of the level among those made. */
void cutmesh_list_all(struct cutmesh *mesh);
/* Splits triangles until none has an edge that is cut. Returns the number of pieces made. */
size_t cutmesh_apply(struct cutmesh *mesh);
/* Puts a new vertex into a triangle. Returns it. */
uint32_t cutmesh_insert(struct cutmesh *mesh, size_t tri, const double weights[3], const float position_m[3]);

/* Two triangles at an edge whose corners there are the same vertices: tris[1] has them the other way round. The edge between their other
   corners, which need not be in the level; TRIMESH_NONE: they are no such two. */
uint32_t cutmesh_across(struct cutmesh *mesh, const uint32_t tris[2], uint32_t edge);
/* Has that edge in place of this one. */
void cutmesh_turn(struct cutmesh *mesh, const uint32_t tris[2], uint32_t edge);

/* Which way the surface looks at an edge; of no certain length. */
void cutmesh_normal(const struct cutmesh *mesh, const struct cut_edge *edge, double normal[3]);

#endif
