/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of the bounding volume hierarchy (bvh*.c). */
#ifndef SURFACE_MESH_BVH_IMPL_H
#define SURFACE_MESH_BVH_IMPL_H
#include "surface/mesh/bvh.h"

#define BVH_WIDE 8
#define BVH_IS_TRIANGLE 0x80000000u /* flag in bvh_wide.child: the rest of the number is a triangle's index, not a node's */
#define BVH_STACK 256               /* entries of the traversal stack: each level leaves at most seven, and there are at most 10 levels */

struct bvh_node {
    double low[3], high[3];
    /* leaf: range of its triangles in `order`; else count is 0, first is the right child, and the left child is the next node */
    uint32_t first, count;
};

struct bvh {
    const struct trimesh *mesh;
    struct bvh_node *nodes;
    uint32_t *order;
    double (*centres)[3];
    size_t node_count, node_capacity;
    struct bvh_wide { /* node with eight children, down to single triangles, with the same boxes as the binary tree; used by queries */
        float low[3][BVH_WIDE], high[3][BVH_WIDE];
        uint32_t child[BVH_WIDE]; /* index of a node, or of a triangle with the flag set; unused children have an inverted box */
    } * wide;                     /* children precede parents, so the root is last */
    size_t wide_count, wide_capacity;
};

/* Builds the nodes of eight children (bvh->wide), which queries use, from the binary tree. Their float boxes enclose the double ones. */
void bvh_build_wide(struct bvh *bvh);

/* Computes where the line through p meets a triangle: t in multiples of `direction`, unbounded, and the barycentric weights. Returns false
   if the line misses the triangle. */
bool bvh_line_meets(const double p[3], const double direction[3], const double a[3], const double b[3], const double c[3], double *t,
                    double weights[3]);

#endif
