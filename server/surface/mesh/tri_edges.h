/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The edges of triangles: which triangles meet at each, and which way round these run. Thread: one, unless constant. */
#ifndef SURFACE_MESH_TRI_EDGES_H
#define SURFACE_MESH_TRI_EDGES_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A side of a triangle: 3 t + i is that of triangle t from its corner i to the next. */
struct tri_edge {
    uint32_t sides[2], faces; /* the first two of the sides that lie here; how many do */
};

struct tri_edges {
    const uint32_t (*tris)[3]; /* borrowed */
    size_t tri_count;
    struct tri_edge *edges;
    uint32_t *of_side;
};

/* Lists the edges of triangles, which must live as long. Finish with tri_edges_finish(). tri_edges_try_init returns false if out of memory,
   and then there is nothing to finish. */
void tri_edges_init(struct tri_edges *e, const uint32_t (*tris)[3], size_t tri_count);
bool tri_edges_try_init(struct tri_edges *e, const uint32_t (*tris)[3], size_t tri_count);
/* Frees the lists. */
void tri_edges_finish(struct tri_edges *e);

static inline const struct tri_edge *tri_edges_at(const struct tri_edges *e, size_t t, int i)
{
    return &e->edges[e->of_side[3 * t + (size_t)i]];
}

/* Returns the side of another triangle at the edge where `side` lies, or TRIMESH_NONE if the edge has not exactly two triangles. */
uint32_t tri_edges_across(const struct tri_edges *e, uint32_t side);
/* Returns whether two sides of one edge run the same way along it: one of their triangles is flipped. */
bool tri_edges_run_alike(const struct tri_edges *e, uint32_t side, uint32_t other);

/* Finds which way round each triangle is that is joined with `first` by edges of two triangles: 1 as `first`, -1 contrary to it, in
   facing[triangle], which has to be 0 before. Writes these triangles to `joined`, which has room for all. Sets *two_sided to false where
   they cannot all be turned to one side, as on a Moebius strip. Returns how many they are. */
size_t tri_edges_orient(const struct tri_edges *e, uint32_t first, signed char *facing, uint32_t *joined, bool *two_sided);
/* Does so for all triangles, each as the lowest one that it is joined with. facing: zeroed. */
void tri_edges_orient_all(const struct tri_edges *e, signed char *facing);

#endif
