/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Unfolding distances outwards from a source, nearer points first. */
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "surface/unfold.h"
#include "surface/vec.h"

typedef float lanes __attribute__((vector_size(4 * UNFOLD_FANS)));
typedef int32_t mask __attribute__((vector_size(4 * UNFOLD_FANS))); /* of each lane all bits, or none */

void unfold_walk_finish(struct unfold_walk *walk)
{
    mem_free(walk->distance_m);
    mem_free(walk->settled);
    mem_free(walk->buckets);
    mem_free(walk->items);
    *walk = (struct unfold_walk){ 0 };
}

static bool clear(const struct unfold *unfold, struct unfold_walk *walk)
{
    size_t count = unfold->mesh->point_count;
    if (!walk->distance_m) {
        walk->distance_m = mem_try_array(count, sizeof(*walk->distance_m));
        walk->settled = mem_try_array(count, 1);
        walk->buckets = mem_try_array(unfold->bucket_count, sizeof(*walk->buckets));
        if (!walk->distance_m || !walk->settled || !walk->buckets)
            return false;
        memset(walk->buckets, 0xff, unfold->bucket_count * sizeof(*walk->buckets)); /* a walk leaves them empty */
    }
    for (size_t i = 0; i < count; i++)
        walk->distance_m[i] = INFINITY;
    memset(walk->settled, 0, count);
    walk->item_count = walk->at = 0;
    return true;
}

/* Its turn comes soon, and memory is slow. */
static inline void fetch_fans(const struct unfold *unfold, uint32_t point)
{
    const char *from = (const char *)&unfold->fans[unfold->first[point]], *to = (const char *)&unfold->fans[unfold->first[point + 1]];
    for (; from < to; from += 64)
        __builtin_prefetch(from);
}

static void offer(const struct unfold *unfold, struct unfold_walk *walk, uint32_t point, float distance_m)
{
    if (!(distance_m < walk->distance_m[point]))
        return;
    if (walk->distance_m[point] == INFINITY)
        fetch_fans(unfold, point);
    walk->distance_m[point] = distance_m;
    if (walk->settled[point])
        return; /* nothing goes out from a point twice, or small corrections would run over the whole surface again and again */
    if (walk->item_count == walk->item_capacity)
        mem_grow(&walk->items, &walk->item_capacity, walk->item_count + 1, sizeof(*walk->items));
    uint64_t number = (uint64_t)(distance_m * unfold->steps_per_m);
    uint32_t *bucket = &walk->buckets[(number > walk->at ? number : walk->at) & (unfold->bucket_count - 1)];
    walk->items[walk->item_count] = (struct unfold_item){ point, *bucket };
    *bucket = (uint32_t)walk->item_count++;
}

static inline lanes root(lanes x)
{
    for (int i = 0; i < UNFOLD_FANS; i++)
        x[i] = sqrtf(x[i]);
    return x;
}

static inline bool any(mask which)
{
    uint64_t words[2];
    memcpy(words, &which, sizeof(words));
    return (words[0] | words[1]) != 0;
}

/* What the edge from p (at d) to b (at db, pb away) offers to c, pc away from p: the source is laid out in the triangle's plane on the
   other side of the edge. Where its ray to c does not pass between p and b, or b is not nearer than p: along the edge from p. */
static inline lanes from_edge(lanes d, lanes db, lanes pb, lanes pc, lanes cosine, lanes sine)
{
    const lanes zero = { 0 };
    lanes sx = (d - db) * (d + db) / (2 * pb) + 0.5f * pb, sy2 = (d - sx) * (d + sx), along = d + pc;
    mask seen = (sy2 >= zero) & (db <= d);
    lanes sy = root((lanes)(seen & (mask)sy2)), cx = pc * cosine, cy = pc * sine;
    lanes x = cx - sx, height = cy + sy, cut = sx * cy + cx * sy; /* where the ray cuts the edge, times the height */
    seen &= (cy > zero) & (cut >= zero) & (cut <= pb * height);
    lanes straight = root(x * x + height * height);
    return (lanes)((seen & (mask)straight) | (~seen & (mask)along));
}

static void spread(const struct unfold *unfold, struct unfold_walk *walk, uint32_t point)
{
    const lanes d = walk->distance_m[point] - (lanes){ 0 }, zero = { 0 };
    const struct unfold_fans *end = unfold->fans + unfold->first[point + 1];
    walk->settled[point] = 1;
    for (const struct unfold_fans *fans = unfold->fans + unfold->first[point]; fans < end; fans++) {
        lanes da, db, to_a, to_b, cosine, sine;
        for (int i = 0; i < UNFOLD_FANS; i++) {
            da[i] = walk->distance_m[fans->a[i]];
            db[i] = walk->distance_m[fans->b[i]];
        }
        memcpy(&to_a, fans->to_a_m, sizeof(to_a));
        memcpy(&to_b, fans->to_b_m, sizeof(to_b));
        memcpy(&cosine, fans->cosine, sizeof(cosine));
        memcpy(&sine, fans->sine, sizeof(sine));
        mask a_waits = (da > d) & (to_a >= zero), b_waits = (db > d) & (to_b >= zero);
        if (!any(a_waits | b_waits))
            continue;
        to_a = (lanes)((mask)to_a & INT32_MAX);
        to_b = (lanes)((mask)to_b & INT32_MAX);
        lanes for_a = from_edge(d, db, to_b, to_a, cosine, sine), for_b = from_edge(d, da, to_a, to_b, cosine, sine);
        a_waits &= for_a < da;
        b_waits &= for_b < db;
        for (int i = 0; i < UNFOLD_FANS; i++) {
            if (a_waits[i])
                offer(unfold, walk, fans->a[i], for_a[i]);
            if (b_waits[i])
                offer(unfold, walk, fans->b[i], for_b[i]);
        }
    }
}

bool unfold_from(const struct unfold *unfold, struct unfold_walk *walk, uint32_t tri, const double weights[3])
{
    const struct trimesh *mesh = unfold->mesh;
    const uint32_t *v = mesh->tris[tri];
    double source[3];
    if (!clear(unfold, walk))
        return false;
    for (int axis = 0; axis < 3; axis++)
        source[axis] =
            weights[0] * mesh->points[v[0]][axis] + weights[1] * mesh->points[v[1]][axis] + weights[2] * mesh->points[v[2]][axis];
    for (int i = 0; i < 3; i++)
        offer(unfold, walk, v[i], (float)vec_distance(source, mesh->points[v[i]]));
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
    return true;
}
