/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nearest-point queries on the bounding volume hierarchy, which test the eight boxes of a node at a time. */
#include <float.h>
#include <string.h>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "base/math/simd.h"
#include "base/math/vec.h"
#include "base/mem.h"
#include "surface/mesh/bvh_impl.h"

/* margin added to bounding boxes when they are converted from double to float, relative to the largest coordinate: four rounding errors */
#define BOX_MARGIN 2.4e-7
#define MARGIN 1e-5 /* relative margin for comparing squared distances in floats; much larger than their rounding error */
/* squared area of a triangle, relative to the squares of its sides, above which barycentric weights are exact to eight digits */
#define EXACT_AREA 1e-8
/* a computed barycentric weight above this is certainly positive despite rounding errors, if the triangle's area exceeds EXACT_AREA */
#define SURELY_POSITIVE 1e-6

static void weights_on_edge(const double p[3], const double a[3], const double b[3], double *wa, double *wb)
{
    double ab[3], ap[3];
    vec_sub(b, a, ab);
    vec_sub(p, a, ap);
    double length2 = vec_dot(ab, ab), t = length2 > 0 ? vec_dot(ap, ab) / length2 : 0;
    *wb = min_of(max_of(t, 0), 1);
    *wa = 1 - *wb;
}

/* Writes the barycentric weights of the triangle's point nearest to p. If p projects into the triangle, the projection is that point;
   otherwise it is on an edge. In theory only edges opposite a corner with negative weight matter. But the weights of slivers are too
   inexact for that test, so all three edges are tried. */
void triangle_nearest(const double p[3], const double a[3], const double b[3], const double c[3], double weights[3])
{
    double ab[3], ac[3], ap[3];
    vec_sub(b, a, ab);
    vec_sub(c, a, ac);
    vec_sub(p, a, ap);
    double d00 = vec_dot(ab, ab), d01 = vec_dot(ab, ac), d11 = vec_dot(ac, ac), d20 = vec_dot(ap, ab), d21 = vec_dot(ap, ac);
    double det = d00 * d11 - d01 * d01;
    bool is_sure = det > EXACT_AREA * d00 * d11;
    weights[0] = weights[1] = weights[2] = 0;
    if (det > 0) {
        weights[1] = (d11 * d20 - d01 * d21) / det;
        weights[2] = (d00 * d21 - d01 * d20) / det;
        weights[0] = 1 - weights[1] - weights[2];
        if (weights[0] >= 0 && weights[1] >= 0 && weights[2] >= 0)
            return;
    }
    const double inside[3] = { weights[0], weights[1], weights[2] }, *corners[3] = { a, b, c };
    double best = INFINITY;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3;
        double w[3] = { 0 }, q[3];
        if (is_sure && inside[(i + 2) % 3] > SURELY_POSITIVE)
            continue;
        weights_on_edge(p, corners[i], corners[j], &w[i], &w[j]);
        vec_mix(corners[i], corners[j], w[j], q);
        double d2 = vec_distance2(p, q);
        if (d2 < best) {
            best = d2;
            memcpy(weights, w, sizeof(w));
        }
    }
}

/* Returns true only if the triangle's plane is farther from p than the square root of distance2. Saves the slower search for the triangle's
 * nearest point in most triangles whose bounding box contains p. */
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
    if (d2 > *best2 || (d2 == *best2 && tri > place->tri))
        return;
    *best2 = d2;
    place->tri = tri;
    memcpy(place->weights, w, sizeof(w));
    memcpy(place->point, q, sizeof(q));
}

/* --- nodes with eight children, whose eight boxes are tested at a time ------------------------------------------------------------- */

struct bvh_box {
    float low[3], high[3];
};

static struct bvh_box box_of_tri(const struct trimesh *mesh, uint32_t tri)
{
    struct bvh_box box;
    const double *a = mesh->points[mesh->tris[tri][0]], *b = mesh->points[mesh->tris[tri][1]], *c = mesh->points[mesh->tris[tri][2]];
    for (int axis = 0; axis < 3; axis++) {
        double margin = BOX_MARGIN * max_of(fabs(a[axis]), max_of(fabs(b[axis]), fabs(c[axis])));
        box.low[axis] = (float)(min_of(a[axis], min_of(b[axis], c[axis])) - margin);
        box.high[axis] = (float)(max_of(a[axis], max_of(b[axis], c[axis])) + margin);
    }
    return box;
}

/* Builds the node with eight children for `count` triangles from order[first] on. The triangles are halved three times per node, until
 * single ones remain; only the root may have fewer than eight children. Returns the node's box. */
static struct bvh_box build_wide(struct bvh *bvh, uint32_t first, uint32_t count, int halvings)
{
    uint32_t firsts[BVH_WIDE + 1] = { first, first + count };
    size_t lanes = 1;
    int own = halvings ? (halvings - 1) % 3 + 1 : 3;
    struct bvh_wide node;
    struct bvh_box all = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
    for (; own > 0 && halvings; own--, lanes *= 2)
        for (size_t i = lanes; i-- > 0;) {
            uint32_t at = firsts[i], end = firsts[i + 1];
            firsts[2 * i + 2] = end;
            firsts[2 * i + 1] = at + (end - at) / 2;
            firsts[2 * i] = at;
        }
    for (size_t i = 0; i < BVH_WIDE; i++) {
        struct bvh_box box = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
        if (!halvings && i < count) {
            node.child[i] = bvh->order[first + i] | BVH_IS_TRIANGLE;
            box = box_of_tri(bvh->mesh, bvh->order[first + i]);
        } else if (halvings && i < lanes) {
            box = build_wide(bvh, firsts[i], firsts[i + 1] - firsts[i], halvings - ((halvings - 1) % 3 + 1));
            node.child[i] = (uint32_t)bvh->wide_count - 1;
        } else {
            node.child[i] = 0;
        }
        for (int axis = 0; axis < 3; axis++) {
            node.low[axis][i] = box.low[axis];
            node.high[axis][i] = box.high[axis];
            all.low[axis] = box.low[axis] < all.low[axis] ? box.low[axis] : all.low[axis];
            all.high[axis] = box.high[axis] > all.high[axis] ? box.high[axis] : all.high[axis];
        }
    }
    mem_grow(&bvh->wide, &bvh->wide_capacity, bvh->wide_count + 1, sizeof(*bvh->wide));
    bvh->wide[bvh->wide_count++] = node;
    return all;
}

void bvh_build_wide(struct bvh *bvh)
{
    const struct trimesh *mesh = bvh->mesh;
    int halvings = 0;
    while ((mesh->tri_count + ((size_t)1 << halvings) - 1) >> halvings > BVH_WIDE)
        halvings++;
    if (mesh->tri_count)
        build_wide(bvh, 0, (uint32_t)mesh->tri_count, halvings);
}

void bvh_set_labels(struct bvh *bvh, const uint32_t *label)
{
    bvh->label = label;
    bvh->wide_label = mem_array(bvh->wide_count, sizeof(*bvh->wide_label));
    for (size_t n = 0; n < bvh->wide_count; n++) {
        const struct bvh_wide *node = &bvh->wide[n];
        bool any = false;
        for (int i = 0; i < BVH_WIDE; i++) {
            if (node->low[0][i] > node->high[0][i]) /* an unused child */
                continue;
            uint32_t child = node->child[i], of = child & BVH_IS_TRIANGLE ? label[child & ~BVH_IS_TRIANGLE] : bvh->wide_label[child];
            bvh->wide_label[n] = !any || of == bvh->wide_label[n] ? of : BVH_MIXED;
            any = true;
        }
    }
}

struct nearest_search {
    const struct bvh *bvh;
    uint32_t skipped; /* label of the triangles that the search skips (bvh_set_labels); BVH_MIXED: it skips none */
    const double *point;
    bool (*allowed)(const void *arg, uint32_t tri);
    const void *arg;
    bool any; /* true: the search ends at any point within the limit; false: at the nearest one */
    double best2;
    struct bvh_place *place;
};

/* Returns the squared search limit as a float, rounded up so that float arithmetic never excludes a point within the limit. */
static inline float in_floats(double best2)
{
    double most = best2 * (1 + MARGIN) + (double)FLT_MIN;
    return most < (double)FLT_MAX ? (float)most : FLT_MAX;
}

/* Type of the functions that compute the squared distances of p from a node's eight boxes (plain C or AVX2). Return a bit mask: bit i is
   set if the squared distance of box i is at most limit2. */
typedef unsigned look(const struct bvh_wide *node, const float p[3], float limit2, float distance2[BVH_WIDE]);

static unsigned look_plain(const struct bvh_wide *node, const float p[3], float limit2, float distance2[BVH_WIDE])
{
    unsigned near = 0;
    for (int i = 0; i < BVH_WIDE; i++) {
        float sum = 0;
        for (int axis = 0; axis < 3; axis++) {
            float below = node->low[axis][i] - p[axis], above = p[axis] - node->high[axis][i], d = below > above ? below : above;
            d = d > 0 ? d : 0;
            sum += d * d;
        }
        distance2[i] = sum;
        near |= (unsigned)(sum <= limit2) << i;
    }
    return near;
}

#if defined(__x86_64__)
SIMD_AVX2 static unsigned look_wide(const struct bvh_wide *node, const float p[3], float limit2, float distance2[BVH_WIDE])
{
    __m256 sum = _mm256_setzero_ps();
    for (int axis = 0; axis < 3; axis++) {
        __m256 at = _mm256_set1_ps(p[axis]);
        __m256 below = _mm256_sub_ps(_mm256_loadu_ps(node->low[axis]), at), above = _mm256_sub_ps(at, _mm256_loadu_ps(node->high[axis]));
        __m256 d = _mm256_max_ps(_mm256_max_ps(below, above), _mm256_setzero_ps());
        sum = _mm256_add_ps(sum, _mm256_mul_ps(d, d));
    }
    _mm256_storeu_ps(distance2, sum);
    return (unsigned)_mm256_movemask_ps(_mm256_cmp_ps(sum, _mm256_set1_ps(limit2), _CMP_LE_OQ));
}
#else
#define look_wide look_plain
#endif

static inline bool is_skipped(const struct nearest_search *s, uint32_t child)
{
    return (child & BVH_IS_TRIANGLE ? s->bvh->label[child & ~BVH_IS_TRIANGLE] : s->bvh->wide_label[child]) == s->skipped;
}

/* Pushes the children whose box is within the limit onto the stack, the nearest on top. An entry has the bits of the squared
 * distance in the upper half, since non-negative floats sort like their bits. The lower half is the child's index. Returns the
 * number of entries pushed. */
SIMD_BODY size_t push_near(const struct nearest_search *s, look *look_at, const struct bvh_wide *node, const float p[3], float limit2,
                           uint64_t *stack)
{
    float distance2[BVH_WIDE];
    size_t count = 0;
    for (unsigned near = look_at(node, p, limit2, distance2); near; near &= near - 1) {
        const int i = __builtin_ctz(near);
        uint32_t bits;
        if (s->skipped != BVH_MIXED && is_skipped(s, node->child[i]))
            continue;
        memcpy(&bits, &distance2[i], sizeof(bits));
        uint64_t own = (uint64_t)bits << 32 | node->child[i];
        size_t at = count++;
        for (; at > 0 && stack[at - 1] < own; at--)
            stack[at] = stack[at - 1];
        stack[at] = own;
    }
    return count;
}

SIMD_BODY void search(struct nearest_search *s, look *look_at)
{
    const float p[3] = { (float)s->point[0], (float)s->point[1], (float)s->point[2] };
    const struct bvh_wide *wide = s->bvh->wide;
    uint64_t stack[BVH_STACK];
    float limit2 = in_floats(s->best2);
    size_t depth = s->bvh->wide_count ? push_near(s, look_at, &wide[s->bvh->wide_count - 1], p, limit2, stack) : 0;
    while (depth) {
        uint64_t top = stack[--depth];
        uint32_t child = (uint32_t)top, bits = (uint32_t)(top >> 32);
        float distance2;
        memcpy(&distance2, &bits, sizeof(bits));
        if (distance2 > limit2)
            continue;
        if (!(child & BVH_IS_TRIANGLE)) {
            depth += push_near(s, look_at, &wide[child], p, limit2, stack + depth);
            continue;
        }
        child &= ~BVH_IS_TRIANGLE;
        if (s->allowed && !s->allowed(s->arg, child))
            continue;
        try_tri(s->bvh, child, s->point, &s->best2, s->place);
        if (s->any && s->place->tri != TRIMESH_NONE)
            return;
        limit2 = in_floats(s->best2);
    }
}

static void search_plain(struct nearest_search *s)
{
    search(s, look_plain);
}

SIMD_AVX2 static void search_wide(struct nearest_search *s)
{
    search(s, look_wide);
}

void bvh_nearest_unlike(const struct bvh *bvh, const double point[3], double limit_m, uint32_t label,
                        bool (*allowed)(const void *arg, uint32_t tri), const void *arg, struct bvh_place *place)
{
    struct nearest_search s = { bvh, label, point, allowed, arg, false, limit_m * limit_m, place };
    *place = (struct bvh_place){ .tri = TRIMESH_NONE, .distance_m = INFINITY };
    (simd_has_avx2() ? search_wide : search_plain)(&s);
    if (place->tri != TRIMESH_NONE)
        place->distance_m = sqrt(s.best2);
}

void bvh_nearest(const struct bvh *bvh, const double point[3], double limit_m, bool (*allowed)(const void *arg, uint32_t tri),
                 const void *arg, struct bvh_place *place)
{
    bvh_nearest_unlike(bvh, point, limit_m, BVH_MIXED, allowed, arg, place);
}

bool bvh_any_within(const struct bvh *bvh, const double point[3], double limit_m, bool (*allowed)(const void *arg, uint32_t tri),
                    const void *arg, uint32_t *tri)
{
    struct bvh_place place = { .tri = TRIMESH_NONE };
    struct nearest_search s = { bvh, BVH_MIXED, point, allowed, arg, true, limit_m * limit_m, &place };
    if (*tri != TRIMESH_NONE && (!allowed || allowed(arg, *tri)))
        try_tri(bvh, *tri, point, &s.best2, &place);
    if (place.tri == TRIMESH_NONE)
        (simd_has_avx2() ? search_wide : search_plain)(&s);
    if (place.tri != TRIMESH_NONE)
        *tri = place.tri;
    return place.tri != TRIMESH_NONE;
}
