/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Overlap and ray queries on the bounding volume hierarchy, which test the eight boxes of a node at a time. Triangles are visited in the
 * order of the tree. */
#include "surface/mesh/bvh.h"

#include <math.h>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "base/math/simd.h"
#include "base/math/vec.h"
#include "surface/mesh/bvh_impl.h"

struct query { /* a box, or a ray */
    double low[3], high[3];
    double origin[3], inverse[3]; /* inverse: 1 / direction */
};

/* Type of the functions that test a node's eight boxes (for a box or a ray; plain C or AVX2). Return a bit mask: bit i is set if the
   query's box or ray meets box i of the node. */
typedef unsigned meet(const struct bvh_wide *node, const struct query *query);

static unsigned meet_box_plain(const struct bvh_wide *node, const struct query *query)
{
    unsigned met = 0;
    for (int i = 0; i < BVH_WIDE; i++) {
        bool apart = false;
        for (int axis = 0; axis < 3; axis++)
            apart = apart || (double)node->low[axis][i] > query->high[axis] || (double)node->high[axis][i] < query->low[axis];
        met |= (unsigned)!apart << i;
    }
    return met;
}

static unsigned meet_ray_plain(const struct bvh_wide *node, const struct query *query)
{
    unsigned met = 0;
    for (int i = 0; i < BVH_WIDE; i++) {
        double near = 0, far = INFINITY;
        for (int axis = 0; axis < 3; axis++) {
            double t0 = ((double)node->low[axis][i] - query->origin[axis]) * query->inverse[axis];
            double t1 = ((double)node->high[axis][i] - query->origin[axis]) * query->inverse[axis];
            near = max_of(near, min_of(t0, t1));
            far = min_of(far, max_of(t0, t1));
        }
        met |= (unsigned)(near <= far && node->low[0][i] <= node->high[0][i]) << i;
    }
    return met;
}

#if defined(__x86_64__)
SIMD_AVX2 static unsigned meet_box_wide(const struct bvh_wide *node, const struct query *query)
{
    unsigned met = 0;
    for (int half = 0; half < 2; half++) {
        __m256d apart = _mm256_setzero_pd();
        for (int axis = 0; axis < 3; axis++) {
            __m256d low = _mm256_cvtps_pd(_mm_loadu_ps(node->low[axis] + 4 * half));
            __m256d high = _mm256_cvtps_pd(_mm_loadu_ps(node->high[axis] + 4 * half));
            apart = _mm256_or_pd(apart, _mm256_cmp_pd(low, _mm256_set1_pd(query->high[axis]), _CMP_GT_OQ));
            apart = _mm256_or_pd(apart, _mm256_cmp_pd(high, _mm256_set1_pd(query->low[axis]), _CMP_LT_OQ));
        }
        met |= (~(unsigned)_mm256_movemask_pd(apart) & 15u) << 4 * half;
    }
    return met;
}

SIMD_AVX2 static unsigned meet_ray_wide(const struct bvh_wide *node, const struct query *query)
{
    unsigned met = 0;
    for (int half = 0; half < 2; half++) {
        __m256d near = _mm256_setzero_pd(), far = _mm256_set1_pd((double)INFINITY);
        __m128 first_low = _mm_loadu_ps(node->low[0] + 4 * half), first_high = _mm_loadu_ps(node->high[0] + 4 * half);
        for (int axis = 0; axis < 3; axis++) {
            __m256d low = _mm256_cvtps_pd(_mm_loadu_ps(node->low[axis] + 4 * half));
            __m256d high = _mm256_cvtps_pd(_mm_loadu_ps(node->high[axis] + 4 * half));
            __m256d from = _mm256_set1_pd(query->origin[axis]), inverse = _mm256_set1_pd(query->inverse[axis]);
            __m256d t0 = _mm256_mul_pd(_mm256_sub_pd(low, from), inverse), t1 = _mm256_mul_pd(_mm256_sub_pd(high, from), inverse);
            near = _mm256_max_pd(near, _mm256_min_pd(t0, t1));
            far = _mm256_min_pd(far, _mm256_max_pd(t0, t1));
        }
        unsigned there = (unsigned)_mm_movemask_ps(_mm_cmple_ps(first_low, first_high));
        met |= ((unsigned)_mm256_movemask_pd(_mm256_cmp_pd(near, far, _CMP_LE_OQ)) & there) << 4 * half;
    }
    return met;
}
#else
#define meet_box_wide meet_box_plain
#define meet_ray_wide meet_ray_plain
#endif

/* Pushes those children of a node whose box the query meets onto the stack, the first child on top. Returns the number of entries
 * pushed. */
static size_t push_met(meet *meets, const struct bvh_wide *node, const struct query *query, uint32_t *stack)
{
    size_t count = 0;
    for (unsigned met = meets(node, query); met;) {
        const int i = 31 - __builtin_clz(met);
        met &= ~(1u << i);
        stack[count++] = node->child[i];
    }
    return count;
}

static void visit_box(const struct bvh *bvh, const struct query *query, meet *meets, void (*visit)(void *arg, uint32_t tri), void *arg)
{
    uint32_t stack[BVH_STACK];
    size_t depth = bvh->wide_count ? push_met(meets, &bvh->wide[bvh->wide_count - 1], query, stack) : 0;
    while (depth) {
        uint32_t child = stack[--depth];
        if (child & BVH_IS_TRIANGLE)
            visit(arg, child & ~BVH_IS_TRIANGLE);
        else
            depth += push_met(meets, &bvh->wide[child], query, stack + depth);
    }
}

void bvh_overlaps(const struct bvh *bvh, const double low[3], const double high[3], double margin_m, void (*visit)(void *arg, uint32_t tri),
                  void *arg)
{
    struct query query;
    for (int axis = 0; axis < 3; axis++) {
        query.low[axis] = low[axis] - margin_m;
        query.high[axis] = high[axis] + margin_m;
    }
    visit_box(bvh, &query, simd_has_avx2() ? meet_box_wide : meet_box_plain, visit, arg);
}

struct bvh_ray {
    const struct bvh *bvh;
    const double *origin, *direction;
    void (*visit)(void *arg, uint32_t tri, double t);
    void *arg;
};

static void visit_if_met(void *arg, uint32_t tri)
{
    const struct bvh_ray *ray = arg;
    const double(*points)[3] = (const double(*)[3])ray->bvh->mesh->points;
    const uint32_t *v = ray->bvh->mesh->tris[tri];
    double t, weights[3];
    if (bvh_line_meets(ray->origin, ray->direction, points[v[0]], points[v[1]], points[v[2]], &t, weights) && t > 0)
        ray->visit(ray->arg, tri, t);
}

void bvh_ray(const struct bvh *bvh, const double origin[3], const double direction[3], void (*visit)(void *arg, uint32_t tri, double t),
             void *arg)
{
    struct bvh_ray ray = { bvh, origin, direction, visit, arg };
    struct query query;
    for (int axis = 0; axis < 3; axis++) {
        query.origin[axis] = origin[axis];
        query.inverse[axis] = 1 / direction[axis];
    }
    visit_box(bvh, &query, simd_has_avx2() ? meet_ray_wide : meet_ray_plain, visit_if_met, &ray);
}
