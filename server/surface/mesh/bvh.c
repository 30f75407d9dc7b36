/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds the bounding volume hierarchy as a binary tree: splits the triangles of a node at their median along the longest side of its
 * box. */
#include "surface/mesh/bvh.h"

#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "surface/mesh/bvh_impl.h"

#define LEAF_TRIS 4u
/* maximum distance between the intersection as computed on the segment and in the triangle, as a fraction of the longest side
   of both. If the distance is larger, segment and triangle are nearly parallel, so that only rounding decides where they meet. */
#define SAME_PLACE 1e-6

static void box_of(const struct bvh *bvh, uint32_t first, uint32_t count, double low[3], double high[3])
{
    for (int axis = 0; axis < 3; axis++) {
        low[axis] = INFINITY;
        high[axis] = -INFINITY;
    }
    for (uint32_t i = first; i < first + count; i++)
        for (int corner = 0; corner < 3; corner++) {
            const double *p = bvh->mesh->points[bvh->mesh->tris[bvh->order[i]][corner]];
            for (int axis = 0; axis < 3; axis++) {
                low[axis] = min_of(low[axis], p[axis]);
                high[axis] = max_of(high[axis], p[axis]);
            }
        }
}

/* Moves the `half` triangles whose centres are lowest along the axis to the front of the range (quickselect). */
static void split_at(struct bvh *bvh, uint32_t first, uint32_t count, uint32_t half, int axis)
{
    uint32_t *v = bvh->order + first;
    uint32_t low = 0, high = count - 1;
    while (low < high) {
        double pivot = bvh->centres[v[low + (high - low) / 2]][axis];
        uint32_t i = low, j = high;
        for (;;) {
            while (bvh->centres[v[i]][axis] < pivot)
                i++;
            while (bvh->centres[v[j]][axis] > pivot)
                j--;
            if (i >= j)
                break;
            uint32_t swap = v[i];
            v[i++] = v[j];
            v[j--] = swap;
        }
        if (half <= j)
            high = j;
        else
            low = j + 1;
    }
}

static void build(struct bvh *bvh, uint32_t first, uint32_t count)
{
    mem_grow(&bvh->nodes, &bvh->node_capacity, bvh->node_count + 1, sizeof(*bvh->nodes));
    size_t self = bvh->node_count++;
    double low[3], high[3];
    box_of(bvh, first, count, low, high);
    memcpy(bvh->nodes[self].low, low, sizeof(low));
    memcpy(bvh->nodes[self].high, high, sizeof(high));
    if (count <= LEAF_TRIS) {
        bvh->nodes[self].first = first;
        bvh->nodes[self].count = count;
        return;
    }
    int axis = 0;
    for (int i = 1; i < 3; i++)
        if (high[i] - low[i] > high[axis] - low[axis])
            axis = i;
    uint32_t half = count / 2;
    split_at(bvh, first, count, half, axis);
    build(bvh, first, half);
    bvh->nodes[self].first = (uint32_t)bvh->node_count;
    bvh->nodes[self].count = 0;
    build(bvh, first + half, count - half);
}

struct bvh *bvh_create(const struct trimesh *mesh)
{
    struct bvh *bvh = mem_new(sizeof(*bvh));
    bvh->mesh = mesh;
    bvh->order = mem_array(mesh->tri_count, sizeof(*bvh->order));
    bvh->centres = mem_array(mesh->tri_count, sizeof(*bvh->centres));
    for (uint32_t t = 0; t < mesh->tri_count; t++) {
        bvh->order[t] = t;
        for (int axis = 0; axis < 3; axis++)
            for (int corner = 0; corner < 3; corner++)
                bvh->centres[t][axis] += mesh->points[mesh->tris[t][corner]][axis] / 3;
    }
    if (mesh->tri_count)
        build(bvh, 0, (uint32_t)mesh->tri_count);
    mem_free(bvh->centres);
    bvh->centres = NULL;
    bvh_build_wide(bvh);
    return bvh;
}

void bvh_destroy(struct bvh **bvh_ptr)
{
    struct bvh *bvh = *bvh_ptr;
    if (!bvh)
        return;
    mem_free(bvh->nodes);
    mem_free(bvh->wide);
    mem_free(bvh->wide_label);
    mem_free(bvh->order);
    mem_free(bvh->centres);
    mem_free(bvh);
    *bvh_ptr = NULL;
}

/* Moeller & Trumbore 1997. */
bool bvh_line_meets(const double p[3], const double direction[3], const double a[3], const double b[3], const double c[3], double *t,
                    double weights[3])
{
    double ab[3], ac[3], ap[3], h[3], q[3];
    vec_sub(b, a, ab);
    vec_sub(c, a, ac);
    vec_cross(direction, ac, h);
    double det = vec_dot(ab, h);
    if (det == 0)
        return false;
    vec_sub(p, a, ap);
    weights[1] = vec_dot(ap, h) / det;
    vec_cross(ap, ab, q);
    weights[2] = vec_dot(direction, q) / det;
    weights[0] = 1 - weights[1] - weights[2];
    *t = vec_dot(ac, q) / det;
    return weights[0] >= 0 && weights[1] >= 0 && weights[2] >= 0;
}

bool triangle_crossed(const double p[3], const double q[3], const double a[3], const double b[3], const double c[3], double *t,
                      double weights[3])
{
    double direction[3], at[3], place[3];
    vec_sub(q, p, direction);
    if (!bvh_line_meets(p, direction, a, b, c, t, weights) || *t < 0 || *t > 1)
        return false;
    vec_mix(p, q, *t, at);
    for (int axis = 0; axis < 3; axis++)
        place[axis] = weights[0] * a[axis] + weights[1] * b[axis] + weights[2] * c[axis];
    return vec_distance(at, place) <= SAME_PLACE * max_of(vec_length(direction), max_of(vec_distance(a, b), vec_distance(a, c)));
}
