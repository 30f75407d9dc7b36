/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of the bounding volume hierarchy (bvh*.c). */
#ifndef SURFACE_MESH_BVH_IMPL_H
#define SURFACE_MESH_BVH_IMPL_H
#include "surface/mesh/bvh.h"

#define BVH_WIDE 8

struct bvh_node {
    double low[3], high[3];
    uint32_t first, count; /* leaf: triangles; else count = 0 and first = right child, the left one follows this node */
};

struct bvh {
    const struct trimesh *mesh;
    struct bvh_node *nodes;
    uint32_t *order;
    double (*centres)[3];
    size_t node_count, node_capacity;
    struct bvh_wide { /* the same boxes, three halvings at once, down to single triangles: for the nearest place */
        float low[3][BVH_WIDE], high[3][BVH_WIDE];
        uint32_t child[BVH_WIDE]; /* or a triangle */
    } * wide;                     /* children before parents: the root is the last one */
    size_t wide_count, wide_capacity;
};

/* Builds the nodes of eight children (bvh->wide), which nearest-point queries use, from the binary tree. */
void bvh_build_wide(struct bvh *bvh);

#endif
