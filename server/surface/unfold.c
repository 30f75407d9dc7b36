/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What meets at each point of a mesh, ready for distances to be unfolded over it. */
#include "surface/unfold.h"

#include <string.h>

#include "base/mem.h"
#include "surface/vec.h"

#define STEPS_PER_EDGE 32.0 /* buckets to a mean edge: points in one bucket are taken in any order */
#define NEAR_EDGES 5.0
#define MAX_BUCKETS (1u << 16)

/* The corners of the t-th triangle walked over, and its sides from corner i to corner i + 1. */
static const uint32_t *tri_points(const struct unfold *unfold, const struct intrinsic *in, size_t t)
{
    return t < in->tri_count ? in->points[t] : unfold->mesh->tris[t];
}

static void tri_sides(const struct unfold *unfold, const struct intrinsic *in, size_t t, double sides[3])
{
    const uint32_t *v = tri_points(unfold, in, t);
    for (int i = 0; i < 3; i++)
        sides[i] = t < in->tri_count ? in->lengths[t][i] : vec_distance(unfold->mesh->points[v[i]], unfold->mesh->points[v[(i + 1) % 3]]);
}

/* How many triangles each point has, then where its fans begin. */
static uint32_t *count_fans(struct unfold *unfold, const struct intrinsic *in)
{
    size_t points = unfold->mesh->point_count;
    uint32_t *counts = mem_array(points, sizeof(*counts));
    for (size_t t = 0; t < unfold->mesh->tri_count; t++)
        for (int i = 0; i < 3; i++)
            counts[tri_points(unfold, in, t)[i]]++;
    for (size_t i = 0; i < points; i++)
        unfold->first[i + 1] = unfold->first[i] + (counts[i] + UNFOLD_FANS - 1) / UNFOLD_FANS;
    memset(counts, 0, points * sizeof(*counts));
    return counts;
}

static void set_empty(struct unfold *unfold)
{
    for (uint32_t p = 0; p < unfold->mesh->point_count; p++)
        for (uint32_t f = unfold->first[p]; f < unfold->first[p + 1]; f++)
            for (int i = 0; i < UNFOLD_FANS; i++) {
                unfold->fans[f].a[i] = unfold->fans[f].b[i] = p;
                unfold->fans[f].to_a_m[i] = unfold->fans[f].to_b_m[i] = INFINITY;
            }
}

static void fill_fans(struct unfold *unfold, const struct intrinsic *in, uint32_t *filled)
{
    for (size_t t = 0; t < unfold->mesh->tri_count; t++) {
        const uint32_t *v = tri_points(unfold, in, t);
        bool inside = t >= in->tri_count;
        double sides[3];
        tri_sides(unfold, in, t, sides);
        for (int i = 0; i < 3; i++) {
            uint32_t a = v[(i + 1) % 3], b = v[(i + 2) % 3], number = filled[v[i]]++;
            double to_a = sides[i], to_b = sides[(i + 2) % 3], across = sides[(i + 1) % 3];
            double cosine = min_of(max_of((to_a * to_a + to_b * to_b - across * across) / (2 * to_a * to_b), -1), 1);
            struct unfold_fans *fans = &unfold->fans[unfold->first[v[i]] + number / UNFOLD_FANS];
            number %= UNFOLD_FANS;
            fans->a[number] = a;
            fans->b[number] = b;
            fans->to_a_m[number] = (float)(inside && !unfold->hidden[a] ? -to_a : to_a);
            fans->to_b_m[number] = (float)(inside && !unfold->hidden[b] ? -to_b : to_b);
            fans->cosine[number] = (float)cosine;
            fans->sine[number] = (float)sqrt(1 - cosine * cosine);
        }
    }
}

/* The ring of buckets must span the longest edge, and what is near: an offer is never farther ahead than that. */
static void choose_buckets(struct unfold *unfold, const struct intrinsic *in)
{
    double sum = 0, longest = 0, sides[3];
    for (size_t t = 0; t < unfold->mesh->tri_count; t++) {
        tri_sides(unfold, in, t, sides);
        sum += sides[0] + sides[1] + sides[2];
        longest = max_of(longest, max_of(sides[0], max_of(sides[1], sides[2])));
    }
    double step_m = max_of(sum / (3 * (double)unfold->mesh->tri_count * STEPS_PER_EDGE), longest / (MAX_BUCKETS - 4));
    unfold->steps_per_m = (float)(1 / step_m);
    unfold->bucket_count = 8;
    unfold->near_m = NEAR_EDGES * sum / (3 * (double)unfold->mesh->tri_count);
    while (unfold->bucket_count < max_of(longest, unfold->near_m) / step_m + 4)
        unfold->bucket_count *= 2;
}

void unfold_init(struct unfold *unfold, const struct trimesh *mesh, size_t visible_count, const struct intrinsic *in)
{
    *unfold = (struct unfold){ .mesh = mesh, .in = in };
    unfold->hidden = mem_array(mesh->point_count, 1);
    unfold->first = mem_array(mesh->point_count + 1, sizeof(*unfold->first));
    memset(unfold->hidden, 1, mesh->point_count);
    for (size_t t = 0; t < visible_count; t++)
        for (int i = 0; i < 3; i++)
            unfold->hidden[mesh->tris[t][i]] = 0;
    uint32_t *filled = count_fans(unfold, in);
    unfold->fans = mem_array(unfold->first[mesh->point_count], sizeof(*unfold->fans));
    set_empty(unfold);
    fill_fans(unfold, in, filled);
    mem_free(filled);
    choose_buckets(unfold, in);
}

void unfold_finish(struct unfold *unfold)
{
    mem_free(unfold->first);
    mem_free(unfold->fans);
    mem_free(unfold->hidden);
    *unfold = (struct unfold){ 0 };
}
