/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Declarations shared by the files of the bounding volume hierarchy (bvh*.c). */
#ifndef SURFACE_MESH_BVH_IMPL_H
#define SURFACE_MESH_BVH_IMPL_H
#include "surface/mesh/bvh.h"

#define BVH_WIDE 8
#define BVH_IS_TRIANGLE 0x80000000u /* flag in bvh_wide.child: the rest of the number is a triangle's index, not a node's */
/* maximum number of entries on the traversal stack: each level of the tree leaves at most seven there, and nodes with eight
   children form at most 10 levels */
#define BVH_STACK 256

struct bvh_node {
    double low[3], high[3];
    /* leaf: its `count` triangles begin at order[first]. Inner node: count is 0, `first` is the index of the right child, and
       the left child follows the node directly */
    uint32_t first, count;
};

struct bvh {
    const struct trimesh *mesh;
    struct bvh_node *nodes;
    uint32_t *order;
    double (*centres)[3];
    size_t node_count, node_capacity;
    /* Node with eight children, used by queries. The tree of these nodes divides the triangles like the binary tree, but down
     * to single triangles. */
    struct bvh_wide {
        float low[3][BVH_WIDE], high[3][BVH_WIDE];
        /* index of a child node, or index of a triangle with BVH_IS_TRIANGLE set; unused children have a box with low > high */
        uint32_t child[BVH_WIDE];
    } * wide; /* nodes with eight children; children come before their parent, so the root is the last node */
    size_t wide_count, wide_capacity;
    const uint32_t *label; /* by triangle; NULL: no labels */
    uint32_t *wide_label;  /* by node of eight children: the label that all its triangles have, or BVH_MIXED */
};
#define BVH_MIXED UINT32_MAX

/* Builds bvh->wide, the nodes with eight children that queries use, from the binary tree. Their float boxes enclose the double boxes. */
void bvh_build_wide(struct bvh *bvh);

/* Computes where the line through p meets a triangle: t, the position on the line in multiples of `direction` (any sign), and the
 * barycentric weights. Returns false if the line misses the triangle. */
bool bvh_line_meets(const double p[3], const double direction[3], const double a[3], const double b[3], const double c[3], double *t,
                    double weights[3]);

#endif
