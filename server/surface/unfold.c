/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Unfolding distances outwards from a source, nearer points first. */
#include "surface/unfold.h"

#include <string.h>

#include "base/mem.h"
#include "surface/vec.h"

#define CLOSED 0x80000000u  /* in a fan's a or b */
#define STEPS_PER_EDGE 32.0 /* buckets to a mean edge: points in one bucket are taken in any order */
#define MAX_BUCKETS (1u << 16)

/* The corners of the t-th triangle walked over, and its sides from corner i to corner i + 1. */
static const uint32_t *tri_points(const struct unfold *unfold, size_t t)
{
    return t < unfold->in->tri_count ? unfold->in->points[t] : unfold->mesh->tris[t];
}

static void tri_sides(const struct unfold *unfold, size_t t, double sides[3])
{
    const uint32_t *v = tri_points(unfold, t);
    for (int i = 0; i < 3; i++)
        sides[i] = t < unfold->in->tri_count ? unfold->in->lengths[t][i]
                                             : vec_distance(unfold->mesh->points[v[i]], unfold->mesh->points[v[(i + 1) % 3]]);
}

static void count_fans(struct unfold *unfold)
{
    for (size_t t = 0; t < unfold->mesh->tri_count; t++)
        for (int i = 0; i < 3; i++)
            unfold->first[tri_points(unfold, t)[i] + 2]++;
    for (size_t i = 2; i < unfold->mesh->point_count + 2; i++)
        unfold->first[i] += unfold->first[i - 1];
}

static void fill_fans(struct unfold *unfold)
{
    for (size_t t = 0; t < unfold->mesh->tri_count; t++) {
        const uint32_t *v = tri_points(unfold, t);
        bool inside = t >= unfold->in->tri_count;
        double sides[3];
        tri_sides(unfold, t, sides);
        for (int i = 0; i < 3; i++) {
            uint32_t a = v[(i + 1) % 3], b = v[(i + 2) % 3];
            double to_a = sides[i], to_b = sides[(i + 2) % 3], across = sides[(i + 1) % 3];
            double cosine = min_of(max_of((to_a * to_a + to_b * to_b - across * across) / (2 * to_a * to_b), -1), 1);
            unfold->fans[unfold->first[v[i] + 1]++] = (struct unfold_fan){
                .a = a | (inside && !unfold->hidden[a] ? CLOSED : 0),
                .b = b | (inside && !unfold->hidden[b] ? CLOSED : 0),
                .to_a_m = (float)to_a,
                .to_b_m = (float)to_b,
                .cosine = (float)cosine,
                .sine = (float)sqrt(1 - cosine * cosine),
            };
        }
    }
}

/* The ring of buckets must span the longest edge: an offer is never farther ahead than that. */
static void choose_buckets(struct unfold *unfold)
{
    size_t fans = 3 * unfold->mesh->tri_count;
    double sum = 0, longest = 0;
    for (size_t i = 0; i < fans; i++) {
        sum += (double)unfold->fans[i].to_a_m;
        longest = max_of(longest, (double)unfold->fans[i].to_a_m);
    }
    double step_m = max_of(sum / ((double)fans * STEPS_PER_EDGE), longest / (MAX_BUCKETS - 4));
    unfold->steps_per_m = 1 / step_m;
    unfold->bucket_count = 8;
    while (unfold->bucket_count < longest / step_m + 4)
        unfold->bucket_count *= 2;
}

void unfold_init(struct unfold *unfold, const struct trimesh *mesh, size_t visible_count, const struct intrinsic *in)
{
    *unfold = (struct unfold){ .mesh = mesh, .in = in };
    unfold->hidden = mem_array(mesh->point_count, 1);
    unfold->first = mem_array(mesh->point_count + 2, sizeof(*unfold->first));
    unfold->fans = mem_array(3 * mesh->tri_count, sizeof(*unfold->fans));
    memset(unfold->hidden, 1, mesh->point_count);
    for (size_t t = 0; t < visible_count; t++)
        for (int i = 0; i < 3; i++)
            unfold->hidden[mesh->tris[t][i]] = 0;
    count_fans(unfold);
    fill_fans(unfold);
    choose_buckets(unfold);
}

void unfold_finish(struct unfold *unfold)
{
    mem_free(unfold->first);
    mem_free(unfold->fans);
    mem_free(unfold->hidden);
    *unfold = (struct unfold){ 0 };
}

void unfold_walk_finish(struct unfold_walk *walk)
{
    mem_free(walk->distance_m);
    mem_free(walk->settled);
    mem_free(walk->buckets);
    mem_free(walk->items);
    *walk = (struct unfold_walk){ 0 };
}

static void clear(const struct unfold *unfold, struct unfold_walk *walk)
{
    if (!walk->distance_m) {
        walk->distance_m = mem_array(unfold->mesh->point_count, sizeof(*walk->distance_m));
        walk->settled = mem_array(unfold->mesh->point_count, 1);
        walk->buckets = mem_array(unfold->bucket_count, sizeof(*walk->buckets));
        memset(walk->buckets, 0xff, unfold->bucket_count * sizeof(*walk->buckets)); /* a walk leaves them empty */
    }
    for (size_t i = 0; i < unfold->mesh->point_count; i++)
        walk->distance_m[i] = INFINITY;
    memset(walk->settled, 0, unfold->mesh->point_count);
    walk->item_count = walk->at = 0;
}

static void offer(const struct unfold *unfold, struct unfold_walk *walk, uint32_t point, double distance_m)
{
    if (!(distance_m < walk->distance_m[point]))
        return;
    walk->distance_m[point] = distance_m;
    if (walk->settled[point])
        return; /* nothing goes out from a point twice, or small corrections would run over the whole surface again and again */
    if (walk->item_count == walk->item_capacity)
        mem_grow(&walk->items, &walk->item_capacity, walk->item_count + 1, sizeof(*walk->items));
    uint64_t number = (uint64_t)(distance_m * unfold->steps_per_m);
    uint32_t *bucket = &walk->buckets[(number > walk->at ? number : walk->at) & (unfold->bucket_count - 1)];
    walk->items[walk->item_count] = (struct unfold_item){ distance_m, point, *bucket };
    *bucket = (uint32_t)walk->item_count++;
}

/* The distance of c, a corner at c_m along and off the edge from p to b, when p and b have theirs: the source is laid out in the
   triangle's plane on the other side of the edge. Where its ray to c does not pass between p and b: along the edge from p. */
static double from_edge(double dp, double db, double pb, double pc, double cosine, double sine)
{
    double sx = (dp * dp - db * db + pb * pb) / (2 * pb), sy2 = dp * dp - sx * sx, cx = pc * cosine, cy = pc * sine;
    if (sy2 < 0 || cy <= 0)
        return dp + pc;
    double sy = sqrt(sy2), height = cy + sy, cut = sx * cy + cx * sy; /* where the ray cuts the edge, times the height */
    if (cut < 0 || cut > pb * height)
        return dp + pc;
    double x = cx - sx;
    return sqrt(x * x + height * height);
}

double unfold_across(double da, double db, double ab, double ac, double bc)
{
    double along_edges = min_of(da + ac, db + bc);
    double sx = (da * da - db * db + ab * ab) / (2 * ab), sy2 = da * da - sx * sx;
    double cx = (ac * ac - bc * bc + ab * ab) / (2 * ab), cy2 = ac * ac - cx * cx;
    if (sy2 < 0)
        return along_edges;
    double sy = -sqrt(sy2), cy = sqrt(max_of(cy2, 0)), cut = cy > sy ? sx + (cx - sx) * -sy / (cy - sy) : cx;
    if (cut < 0 || cut > ab)
        return along_edges;
    return hypot(cx - sx, cy - sy);
}

static void spread(const struct unfold *unfold, struct unfold_walk *walk, uint32_t point)
{
    double d = walk->distance_m[point];
    walk->settled[point] = 1;
    const struct unfold_fan *end = unfold->fans + unfold->first[point + 1];
    for (const struct unfold_fan *fan = unfold->fans + unfold->first[point]; fan < end; fan++) {
        uint32_t a = fan->a & ~CLOSED, b = fan->b & ~CLOSED;
        double da = walk->distance_m[a], db = walk->distance_m[b], to_a = (double)fan->to_a_m, to_b = (double)fan->to_b_m;
        if (da > d && !(fan->a & CLOSED))
            offer(unfold, walk, a, db <= d ? from_edge(d, db, to_b, to_a, (double)fan->cosine, (double)fan->sine) : d + to_a);
        if (db > d && !(fan->b & CLOSED))
            offer(unfold, walk, b, da <= d ? from_edge(d, da, to_a, to_b, (double)fan->cosine, (double)fan->sine) : d + to_b);
    }
}

void unfold_from(const struct unfold *unfold, struct unfold_walk *walk, uint32_t tri, const double weights[3])
{
    const struct trimesh *mesh = unfold->mesh;
    const uint32_t *v = mesh->tris[tri];
    double source[3];
    clear(unfold, walk);
    for (int axis = 0; axis < 3; axis++)
        source[axis] =
            weights[0] * mesh->points[v[0]][axis] + weights[1] * mesh->points[v[1]][axis] + weights[2] * mesh->points[v[2]][axis];
    for (int i = 0; i < 3; i++)
        offer(unfold, walk, v[i], vec_distance(source, mesh->points[v[i]]));
    for (uint32_t empty = 0; empty < unfold->bucket_count; walk->at++) {
        uint32_t *bucket = &walk->buckets[walk->at & (unfold->bucket_count - 1)];
        empty = *bucket == TRIMESH_NONE ? empty + 1 : 0;
        while (*bucket != TRIMESH_NONE) {
            struct unfold_item item = walk->items[*bucket];
            *bucket = item.next;
            if (!walk->settled[item.point]) /* else it was reached by a shorter way */
                spread(unfold, walk, item.point);
        }
    }
}
