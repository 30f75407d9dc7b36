/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The edges of triangles: the triangles that meet at each edge, and the direction of their sides along it. Call from one thread
 * only; a const object can be read from any. */
#ifndef SURFACE_MESH_TRI_EDGES_H
#define SURFACE_MESH_TRI_EDGES_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Sides are numbered: 3 t + i is the side of triangle t from its corner i to the next. */
struct tri_edge {
    /* sides: the first two sides at this edge; faces: number of sides at this edge, that is, of triangles that meet there */
    uint32_t sides[2], faces;
};

struct tri_edges {
    const uint32_t (*tris)[3]; /* borrowed */
    size_t tri_count;
    struct tri_edge *edges;
    uint32_t *of_side;
};

/* Build the edges of a mesh. tri_edges_init() aborts when out of memory; tri_edges_try_init() returns false, and then nothing needs
   freeing. `tris` must outlive the result. Free with tri_edges_finish(). */
void tri_edges_init(struct tri_edges *e, const uint32_t (*tris)[3], size_t tri_count);
bool tri_edges_try_init(struct tri_edges *e, const uint32_t (*tris)[3], size_t tri_count);
/* Frees the lists. */
void tri_edges_finish(struct tri_edges *e);

static inline const struct tri_edge *tri_edges_at(const struct tri_edges *e, size_t t, int i)
{
    return &e->edges[e->of_side[3 * t + (size_t)i]];
}

/* Returns the side of the other triangle at the edge of `side`, or TRIMESH_NONE if the edge does not have exactly two triangles. */
uint32_t tri_edges_across(const struct tri_edges *e, uint32_t side);
/* Returns whether two sides of one edge run in the same direction along it, which means that their triangles have opposite orientations. */
bool tri_edges_run_alike(const struct tri_edges *e, uint32_t side, uint32_t other);

/* Finds the orientation of all triangles connected with `first` by edges of two triangles. facing[triangle] receives 1 (oriented as
 * `first`) or -1 (opposite); all elements must be 0 before. Writes these triangles to `joined`, which has room for all. Sets *two_sided to
 * false where no consistent orientation exists, as on a Moebius strip. Returns the number of these triangles. */
size_t tri_edges_orient(const struct tri_edges *e, uint32_t first, signed char *facing, uint32_t *joined, bool *two_sided);
/* Orients all triangles relative to their neighbours: facing[triangle] receives 1 or -1. In each set of triangles connected by edges of
   exactly two triangles, the triangle with the lowest index gets 1. facing: zeroed by the caller. */
void tri_edges_orient_all(const struct tri_edges *e, signed char *facing);

#endif
