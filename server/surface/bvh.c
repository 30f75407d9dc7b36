/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Boxes around boxes around triangles, split at the middle of the longer side. */
#include "surface/bvh.h"

#include <string.h>

#include "base/mem.h"
#include "surface/vec.h"

#define LEAF_TRIS 4u
#define STACK_NODES 128

struct node {
    double low[3], high[3];
    uint32_t first, count; /* leaf: triangles; else count = 0 and first = right child, the left one follows this node */
};

struct bvh {
    const struct trimesh *mesh;
    struct node *nodes;
    uint32_t *order;
    double (*centres)[3];
    size_t node_count, node_capacity;
};

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

/* Moves the triangles with the `half` lowest centres to the front (quickselect). */
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
    return bvh;
}

void bvh_destroy(struct bvh **bvh_ptr)
{
    struct bvh *bvh = *bvh_ptr;
    if (!bvh)
        return;
    mem_free(bvh->nodes);
    mem_free(bvh->order);
    mem_free(bvh->centres);
    mem_free(bvh);
    *bvh_ptr = NULL;
}

static void weights_on_edge(const double p[3], const double a[3], const double b[3], double *wa, double *wb)
{
    double ab[3], ap[3];
    vec_sub(b, a, ab);
    vec_sub(p, a, ap);
    double length2 = vec_dot(ab, ab), t = length2 > 0 ? vec_dot(ap, ab) / length2 : 0;
    *wb = min_of(max_of(t, 0), 1);
    *wa = 1 - *wb;
}

/* Inside the prism over the triangle: barycentric weights; else the best of its three edges. */
void triangle_nearest(const double p[3], const double a[3], const double b[3], const double c[3], double weights[3])
{
    double ab[3], ac[3], ap[3];
    vec_sub(b, a, ab);
    vec_sub(c, a, ac);
    vec_sub(p, a, ap);
    double d00 = vec_dot(ab, ab), d01 = vec_dot(ab, ac), d11 = vec_dot(ac, ac), d20 = vec_dot(ap, ab), d21 = vec_dot(ap, ac);
    double det = d00 * d11 - d01 * d01;
    if (det > 0) {
        weights[1] = (d11 * d20 - d01 * d21) / det;
        weights[2] = (d00 * d21 - d01 * d20) / det;
        weights[0] = 1 - weights[1] - weights[2];
        if (weights[0] >= 0 && weights[1] >= 0 && weights[2] >= 0)
            return;
    }
    const double *corners[3] = { a, b, c };
    double best = INFINITY;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3;
        double w[3] = { 0 }, q[3];
        weights_on_edge(p, corners[i], corners[j], &w[i], &w[j]);
        vec_mix(corners[i], corners[j], w[j], q);
        double d2 = vec_distance2(p, q);
        if (d2 < best) {
            best = d2;
            memcpy(weights, w, sizeof(w));
        }
    }
}

static double box_distance2(const struct node *node, const double p[3])
{
    double sum = 0;
    for (int axis = 0; axis < 3; axis++) {
        double d = max_of(max_of(node->low[axis] - p[axis], p[axis] - node->high[axis]), 0);
        sum += d * d;
    }
    return sum;
}

/* Most triangles in a box that p is in are. */
static bool plane_is_farther(const double p[3], const double a[3], const double b[3], const double c[3], double distance2)
{
    double ab[3], ac[3], ap[3], n[3];
    vec_sub(b, a, ab);
    vec_sub(c, a, ac);
    vec_sub(p, a, ap);
    vec_cross(ab, ac, n);
    double height = vec_dot(ap, n), length2 = vec_dot(n, n);
    return height * height > distance2 * length2 * (1 + 1e-9);
}

bool triangle_is_farther(const double p[3], const double a[3], const double b[3], const double c[3], double distance_m)
{
    for (int i = 0; i < 3; i++)
        if (p[i] < min_of(a[i], min_of(b[i], c[i])) - distance_m || p[i] > max_of(a[i], max_of(b[i], c[i])) + distance_m)
            return true;
    return plane_is_farther(p, a, b, c, distance_m * distance_m);
}

static void try_tri(const struct bvh *bvh, uint32_t tri, const double p[3], double *best2, struct bvh_place *place)
{
    const uint32_t *v = bvh->mesh->tris[tri];
    const double *a = bvh->mesh->points[v[0]], *b = bvh->mesh->points[v[1]], *c = bvh->mesh->points[v[2]];
    double w[3], q[3];
    if (plane_is_farther(p, a, b, c, *best2))
        return;
    triangle_nearest(p, a, b, c, w);
    for (int axis = 0; axis < 3; axis++)
        q[axis] = w[0] * a[axis] + w[1] * b[axis] + w[2] * c[axis];
    double d2 = vec_distance2(p, q);
    if (d2 > *best2 || (d2 == *best2 && place->tri != TRIMESH_NONE))
        return;
    *best2 = d2;
    place->tri = tri;
    memcpy(place->weights, w, sizeof(w));
    memcpy(place->point, q, sizeof(q));
}

void bvh_nearest(const struct bvh *bvh, const double point[3], double limit_m, bool (*allowed)(const void *arg, uint32_t tri),
                 const void *arg, struct bvh_place *place)
{
    struct {
        uint32_t node;
        double distance2;
    } stack[STACK_NODES];
    int depth = 0;
    double best2 = limit_m * limit_m;
    *place = (struct bvh_place){ .tri = TRIMESH_NONE, .distance_m = INFINITY };
    if (bvh->node_count) {
        stack[depth].distance2 = 0;
        stack[depth++].node = 0;
    }
    while (depth) {
        uint32_t at = stack[--depth].node;
        if (stack[depth].distance2 > best2)
            continue;
        const struct node *node = &bvh->nodes[at];
        while (!node->count) { /* down into the nearer one; the other waits */
            uint32_t near = at + 1, far = node->first;
            double near2 = box_distance2(&bvh->nodes[near], point), far2 = box_distance2(&bvh->nodes[far], point);
            if (near2 > far2) {
                uint32_t swap = near;
                double swap2 = near2;
                near = far;
                near2 = far2;
                far = swap;
                far2 = swap2;
            }
            if (near2 > best2)
                break;
            if (far2 <= best2) {
                stack[depth].distance2 = far2;
                stack[depth++].node = far;
            }
            at = near;
            node = &bvh->nodes[at];
        }
        for (uint32_t i = node->first; i < node->first + node->count; i++)
            if (!allowed || allowed(arg, bvh->order[i]))
                try_tri(bvh, bvh->order[i], point, &best2, place);
    }
    if (place->tri != TRIMESH_NONE)
        place->distance_m = sqrt(best2);
}

static bool any_of_node(const struct bvh *bvh, const struct node *node, const double point[3], double limit2,
                        bool (*allowed)(const void *arg, uint32_t tri), const void *arg)
{
    struct bvh_place place = { .tri = TRIMESH_NONE };
    for (uint32_t i = 0; i < node->count && place.tri == TRIMESH_NONE; i++) {
        uint32_t tri = bvh->order[node->first + i];
        if (!allowed || allowed(arg, tri))
            try_tri(bvh, tri, point, &limit2, &place);
    }
    return place.tri != TRIMESH_NONE;
}

bool bvh_any_within(const struct bvh *bvh, const double point[3], double limit_m, bool (*allowed)(const void *arg, uint32_t tri),
                    const void *arg)
{
    uint32_t stack[STACK_NODES];
    int depth = 0;
    double limit2 = limit_m * limit_m;
    if (bvh->node_count)
        stack[depth++] = 0;
    while (depth) {
        uint32_t at = stack[--depth];
        const struct node *node = &bvh->nodes[at];
        if (node->count) {
            if (any_of_node(bvh, node, point, limit2, allowed, arg))
                return true;
            continue;
        }
        uint32_t near = at + 1, far = node->first;
        double near2 = box_distance2(&bvh->nodes[near], point), far2 = box_distance2(&bvh->nodes[far], point);
        bool swap = near2 > far2;
        if (fmax(near2, far2) <= limit2)
            stack[depth++] = swap ? near : far;
        if (fmin(near2, far2) <= limit2)
            stack[depth++] = swap ? far : near;
    }
    return false;
}

void bvh_overlaps(const struct bvh *bvh, const double low[3], const double high[3], double margin_m, void (*visit)(void *arg, uint32_t tri),
                  void *arg)
{
    uint32_t stack[STACK_NODES];
    int depth = 0;
    if (bvh->node_count)
        stack[depth++] = 0;
    while (depth) {
        uint32_t at = stack[--depth];
        const struct node *node = &bvh->nodes[at];
        bool apart = false;
        for (int axis = 0; axis < 3; axis++)
            apart = apart || node->low[axis] > high[axis] + margin_m || node->high[axis] < low[axis] - margin_m;
        if (apart)
            continue;
        if (node->count) {
            for (uint32_t i = node->first; i < node->first + node->count; i++)
                visit(arg, bvh->order[i]);
        } else {
            stack[depth++] = node->first;
            stack[depth++] = at + 1;
        }
    }
}

/* Moeller & Trumbore 1997. t in lengths of direction, unbounded. */
static bool line_meets(const double p[3], const double direction[3], const double a[3], const double b[3], const double c[3], double *t,
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
    double direction[3];
    vec_sub(q, p, direction);
    return line_meets(p, direction, a, b, c, t, weights) && *t >= 0 && *t <= 1;
}

static bool box_meets_ray(const struct node *node, const double origin[3], const double inverse[3])
{
    double near = 0, far = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        double t0 = (node->low[axis] - origin[axis]) * inverse[axis], t1 = (node->high[axis] - origin[axis]) * inverse[axis];
        near = max_of(near, min_of(t0, t1));
        far = min_of(far, max_of(t0, t1));
    }
    return near <= far;
}

void bvh_ray(const struct bvh *bvh, const double origin[3], const double direction[3], void (*visit)(void *arg, uint32_t tri, double t),
             void *arg)
{
    uint32_t stack[STACK_NODES];
    int depth = 0;
    const double inverse[3] = { 1 / direction[0], 1 / direction[1], 1 / direction[2] };
    if (bvh->node_count)
        stack[depth++] = 0;
    while (depth) {
        uint32_t at = stack[--depth];
        const struct node *node = &bvh->nodes[at];
        if (!box_meets_ray(node, origin, inverse))
            continue;
        for (uint32_t i = node->first; i < node->first + node->count; i++) {
            const uint32_t *v = bvh->mesh->tris[bvh->order[i]];
            double t, weights[3];
            if (line_meets(origin, direction, bvh->mesh->points[v[0]], bvh->mesh->points[v[1]], bvh->mesh->points[v[2]], &t, weights) &&
                t > 0)
                visit(arg, bvh->order[i], t);
        }
        if (!node->count) {
            stack[depth++] = node->first;
            stack[depth++] = at + 1;
        }
    }
}
