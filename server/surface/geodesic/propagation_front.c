/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes distances by propagation from a source outwards, nearest points first. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "base/math/simd.h"
#include "base/math/vec.h"
#include "base/mem.h"
#include "surface/geodesic/propagation.h"

/* minimum barycentric weight of a source's position in its triangle; a source on a corner or edge is moved inwards to that
   extent */
#define MIN_WEIGHT 1e-6
/* Used by lay_out_beyond(), which follows a straight line to the triangle with a given corner. Several triangles meet at the
   corner itself, so the line ends a little inside the triangle. Its end lies between the corner and the middle of the opposite
   side, at this fraction of the distance between the two. Also the tolerance for the corner's position, as a fraction of that
   side's length. */
#define CORNER_OFFSET 1e-3
/* Points whose distances differ by up to this many buckets of the priority queue may be processed in any order. Distances count as final up
   to the current bucket plus this many. */
#define ANY_ORDER 2
/* maximum number of triangles that a straight line from the source crosses; points beyond get their distance by propagation
   instead */
#define MAX_DEPTH 32
/* Limits for finding the intrinsic triangle that contains the source (lies_in()): barycentric weights are at least -OUTSIDE, the
   source is off the triangle's plane by at most OFF_PLANE of its longest side, and its sides are as long as in space, except for
   BENT of the longest side. Besides, coordinates are rounded to ROUNDING of the greatest one, because models have single
   precision. */
#define OUTSIDE 1e-3
#define OFF_PLANE 1e-5
#define BENT 1e-4
#define ROUNDING (4 * (double)FLT_EPSILON)
#define NO_LENGTH 1e-300 /* avoids division by 0 */
/* A point whose neighbours already have offers is processed again if its distance falls by at least this fraction. Each smaller
   correction would spread over the whole surface. */
#define CORRECTION 1e-4f
/* maximum number of entries in the queue per point of the mesh, which bounds the time that corrections take */
#define MAX_ENTRIES 16

/* states of a point: not yet processed; processed; to be processed again with a shorter distance */
enum { WAITING, SETTLED, CORRECTED };

typedef float lanes __attribute__((vector_size(4 * PROPAGATION_FAN)));
/* mask with one lane per neighbour, whose bits are all set or all clear */
typedef int32_t mask __attribute__((vector_size(4 * PROPAGATION_FAN)));

void propagation_front_finish(struct propagation_front *front)
{
    mem_free(front->distance_m);
    mem_free(front->bend_m);
    mem_free(front->straight_m);
    mem_free(front->state);
    mem_free(front->buckets);
    mem_free(front->items);
    *front = (struct propagation_front){ 0 };
}

static bool clear(const struct propagation *propagation, struct propagation_front *front)
{
    size_t count = propagation->mesh->point_count;
    if (!front->distance_m) {
        front->distance_m = mem_try_array(count, sizeof(*front->distance_m));
        front->bend_m = mem_try_array(count, sizeof(*front->bend_m));
        front->straight_m = mem_try_array(count, sizeof(*front->straight_m));
        front->state = mem_try_array(count, 1);
        front->buckets = mem_try_array(propagation->bucket_count, sizeof(*front->buckets));
        if (!front->distance_m || !front->bend_m || !front->straight_m || !front->state || !front->buckets)
            return false;
        /* marks the buckets of the priority queue as empty when they are allocated; each propagation leaves them empty for the next one */
        memset(front->buckets, 0xff, propagation->bucket_count * sizeof(*front->buckets));
    }
    for (size_t i = 0; i < count; i++)
        front->distance_m[i] = INFINITY;
    memset(front->state, 0, count);
    front->item_count = front->at = 0;
    return true;
}

/* Prefetches the fans (neighbours and triangles) of a point that will be processed soon. */
static inline void fetch_fans(const struct propagation *propagation, uint32_t point)
{
    const char *from = (const char *)&propagation->fans[propagation->first[point]],
               *to = (const char *)&propagation->fans[propagation->first[point + 1]];
    for (; from < to; from += 64)
        __builtin_prefetch(from);
}

/* Lowers a point's distance to the offered one, but not below the straight-line distance. An offer can be too short where the
   distances at an edge's two ends come from different paths, around a fold or a rod: no position of the source fits both, and
   the computed one is too near. bend_m: distance from the source to the last bend of the offered path. */
static inline void offer(const struct propagation *propagation, struct propagation_front *front, uint32_t point, float offered_m,
                         float bend_m)
{
    float distance_m = offered_m < front->straight_m[point] ? front->straight_m[point] : offered_m;
    if (!(distance_m < front->distance_m[point]))
        return;
    if (front->distance_m[point] == INFINITY)
        fetch_fans(propagation, point);
    const bool is_correction = distance_m < front->distance_m[point] * (1 - CORRECTION);
    front->distance_m[point] = distance_m;
    front->bend_m[point] = bend_m;
    if (front->state[point] == SETTLED && (!is_correction || front->item_count >= MAX_ENTRIES * propagation->mesh->point_count))
        return;
    if (front->state[point] == SETTLED)
        front->state[point] = CORRECTED;
    if (front->item_count == front->item_capacity)
        mem_grow(&front->items, &front->item_capacity, front->item_count + 1, sizeof(*front->items));
    /* Converts the distance to a bucket number via int64_t, for which the processor has a single instruction. Correct, because
       the distance is not negative. */
    uint64_t number = (uint64_t)(int64_t)(distance_m * propagation->steps_per_m);
    uint32_t *bucket = &front->buckets[(number > front->at ? number : front->at) & (propagation->bucket_count - 1)];
    front->items[front->item_count] = (struct propagation_item){ point, *bucket };
    *bucket = (uint32_t)front->item_count++;
}

SIMD_BODY void root(lanes *x)
{
    for (int i = 0; i < PROPAGATION_FAN; i++)
        (*x)[i] = sqrtf((*x)[i]);
}

/* Returns one bit per lane. */
SIMD_BODY uint32_t bits_of(const mask *which)
{
    const mask bits = { 1, 2, 4, 8, 16, 32, 64, 128 }, left = *which & bits;
    uint64_t words[4], all;
    memcpy(words, &left, sizeof(words));
    all = (words[0] | words[1]) | (words[2] | words[3]);
    return (uint32_t)(all | all >> 32);
}

SIMD_BODY void choose(const mask *which, const lanes *x, const lanes *otherwise, lanes *out)
{
    *out = (lanes)((*which & (mask)*x) | (~*which & (mask)*otherwise));
}

/* An edge from p to b, and the side from p to the triangle's third point c, in each lane. */
struct edge_lanes {
    const lanes *d_of_p, *bend_of_p; /* distances from the source to p, and to the last bend of the path to p */
    lanes d_of_b, bend_of_b;
    lanes p_to_b, p_to_c; /* lengths of the edge and of the side */
};

/* Computes, in each lane, the distance at which the path through the edge from p to b reaches point c. p is at distance d from
 * the last bend of its path, b at db. The edge has length pb, the side from p to c length pc and the cosine and sine of its
 * angle to the edge. The bend is placed in the triangle's plane, beyond the edge. The result is INFINITY where the ray from
 * there to c does not pass between p and b. It is also INFINITY where the distance of b exceeds `reached`, because such a
 * distance is not final. *bend: distance from the source to the last bend of the path to c. */
SIMD_BODY void through_edge(const struct edge_lanes *edge, const lanes *reached, const lanes *cosine, const lanes *sine, lanes *bend,
                            lanes *out)
{
    const lanes zero = { 0 }, infinite = zero + INFINITY, pb = edge->p_to_b, pc = edge->p_to_c;
    const lanes bend_of_p = *edge->bend_of_p, later = edge->bend_of_b - bend_of_p;
    /* The earlier of the two bends gives the longer path, which is not too short. */
    mask is_earlier = later < zero;
    lanes shared;
    choose(&is_earlier, &edge->bend_of_b, edge->bend_of_p, &shared);
    const lanes d = *edge->d_of_p - shared, db = edge->d_of_b - shared;
    lanes sx = (d - db) * (d + db) / (2 * pb) + 0.5f * pb, sy2 = (d - sx) * (d + sx);
    mask seen = (sy2 >= zero) & (edge->d_of_b <= *reached);
    lanes sy = (lanes)(seen & (mask)sy2), cx = pc * *cosine, cy = pc * *sine;
    root(&sy);
    /* cut / height: position of the ray's crossing with the edge, measured from p */
    lanes x = cx - sx, height = cy + sy, cut = sx * cy + cx * sy;
    seen &= (cy > zero) & (cut >= zero) & (cut <= pb * height);
    lanes straight = x * x + height * height;
    root(&straight);
    straight += shared;
    *bend = bend_of_p + cut / (pb * height) * later;
    choose(&seen, &straight, &infinite, out);
}

/* State of a front (the propagation from one source) while its current point is processed. */
struct front_turn {
    struct propagation_front *front;
    /* fan being processed (up to PROPAGATION_FAN neighbours of the current point), and end of the current point's fans */
    const struct propagation_fan *fan, *end;
    /* d, bend: distance of the current point and of the last bend of its path, in all lanes; radius: of the arc around which paths
       bend there; reached: distance up to which distances are final */
    lanes d, bend, radius, reached;
    bool is_corrected;                /* the current point is processed again, after points that are farther from the source */
    uint32_t empty;                   /* number of consecutive empty buckets */
    float offered_m[PROPAGATION_FAN]; /* offers to the fan's points */
    float bends_m[PROPAGATION_FAN];   /* distances from the source to the last bends of the offered paths */
    uint32_t takes;                   /* bit mask of lanes in which the offered distance is shorter than the neighbour's current distance */
};

/* Computes where a path that follows the edge from point p, at distance d, to a neighbour bends last: along is its length.
   Around a corner, the path bends at p itself. Around a curve of many points, a shortest path leaves the curve before p: the
   tangent from a point at height h above an arc of radius r has a length of about sqrt(2 r h). */
SIMD_BODY void bend_at(const struct front_turn *turn, const lanes *length_m, const lanes *along, lanes *bend)
{
    lanes tangent = 2 * turn->radius * *length_m;
    root(&tangent);
    *bend = *along - tangent;
    mask is_before = *bend < turn->bend;
    mask is_beyond = *bend > turn->d;
    choose(&is_before, &turn->bend, bend, bend);
    choose(&is_beyond, &turn->d, bend, bend);
}

/* Distances that point p offers to each neighbour (lane) and the next one, through the triangle that the three form: the path passes
   through the edge from p to the other of the two. INFINITY: none. bend: distance from the source to the path's last bend. */
struct triangle_lanes {
    lanes to_this, bend_to_this, to_next, bend_to_next;
};

/* A point p and its neighbours, whose distances from the source and from p are given; next: the same for the next neighbour. */
struct neighbour_lanes {
    const lanes *d, *next_d, *bend, *next_bend, *length, *next_length, *cosine, *sine;
};

/* Writes the offer to one of the two neighbours of each triangle: this one where to_this is set, else the next one. */
SIMD_BODY void through_triangles(const struct front_turn *turn, const struct neighbour_lanes *at, const mask *to_this,
                                 struct triangle_lanes *out)
{
    struct edge_lanes edge = { .d_of_p = &turn->d, .bend_of_p = &turn->bend };
    lanes through, bend;
    choose(to_this, at->next_d, at->d, &edge.d_of_b);
    choose(to_this, at->next_bend, at->bend, &edge.bend_of_b);
    choose(to_this, at->next_length, at->length, &edge.p_to_b);
    choose(to_this, at->length, at->next_length, &edge.p_to_c);
    through_edge(&edge, &turn->reached, at->cosine, at->sine, &bend, &through);
    choose(to_this, &through, &out->to_this, &out->to_this);
    choose(to_this, &bend, &out->bend_to_this, &out->bend_to_this);
    choose(to_this, &out->to_next, &through, &out->to_next);
    choose(to_this, &out->bend_to_next, &bend, &out->bend_to_next);
}

/* Computes the distance that point p, at distance d, offers to each neighbour in a fan: the shorter of two. One is d plus the
 * edge's length. The other passes through the triangle shared with the previous or next neighbour. It exists only if that
 * neighbour is nearer to the source than this one, or p is processed again. bend: distances from the source to the last bends of
 * the paths to the neighbours, and then those of the offered paths. */
SIMD_BODY void offers_of(const struct front_turn *turn, const lanes *d_of_each, const lanes *length_m, const lanes *cosine,
                         const lanes *sine, lanes *bend, lanes *out)
{
    const lanes infinite = (lanes){ 0 } + INFINITY, here = *d_of_each, length = *length_m, bend_here = *bend;
    lanes next = __builtin_shufflevector(here, here, 1, 2, 3, 4, 5, 6, 7, 7);
    lanes next_length = __builtin_shufflevector(length, length, 1, 2, 3, 4, 5, 6, 7, 7);
    lanes next_bend = __builtin_shufflevector(bend_here, bend_here, 1, 2, 3, 4, 5, 6, 7, 7);
    const struct neighbour_lanes at = { &here, &next, &bend_here, &next_bend, &length, &next_length, cosine, sine };
    struct triangle_lanes offers = { infinite, bend_here, infinite, next_bend };
    mask to_farther = here > next, to_nearer = here <= next;
    through_triangles(turn, &at, &to_farther, &offers);
    if (turn->is_corrected)
        through_triangles(turn, &at, &to_nearer, &offers);
    lanes to_next = __builtin_shufflevector(offers.to_next, infinite, 8, 0, 1, 2, 3, 4, 5, 6);
    lanes bend_to_next = __builtin_shufflevector(offers.bend_to_next, infinite, 8, 0, 1, 2, 3, 4, 5, 6);
    lanes through, bend_through, along = turn->d + length;
    mask less = to_next < offers.to_this;
    choose(&less, &to_next, &offers.to_this, &through);
    choose(&less, &bend_to_next, &offers.bend_to_this, &bend_through);
    bend_at(turn, length_m, &along, bend);
    less = through < along;
    choose(&less, &through, &along, out);
    choose(&less, &bend_through, bend, bend);
}

/* Takes the next point from the buckets and makes its fans (neighbours and triangles around it) the current ones. Returns false if all
 * buckets are empty. */
SIMD_BODY bool next_point(const struct propagation *propagation, struct front_turn *turn)
{
    struct propagation_front *front = turn->front;
    for (; turn->empty < propagation->bucket_count; front->at++) {
        uint32_t *bucket = &front->buckets[front->at & (propagation->bucket_count - 1)];
        turn->empty = *bucket == TRIMESH_NONE ? turn->empty + 1 : 0;
        while (*bucket != TRIMESH_NONE) {
            struct propagation_item item = front->items[*bucket];
            *bucket = item.next;
            /* skips outdated entries: a point has one entry in the queue for each time its distance was lowered, and only the
               entry with the shortest distance counts */
            if (front->state[item.point] == SETTLED)
                continue;
            turn->d = front->distance_m[item.point] - (lanes){ 0 };
            turn->bend = front->bend_m[item.point] - (lanes){ 0 };
            turn->radius = propagation->bend_radius_m[item.point] - (lanes){ 0 };
            turn->is_corrected = front->state[item.point] == CORRECTED;
            front->state[item.point] = SETTLED;
            /* neighbours of a corrected point may be final even if they are farther from the source */
            const float own_step = front->distance_m[item.point] * propagation->steps_per_m, step = (float)front->at;
            turn->reached = ((own_step > step ? own_step : step) + ANY_ORDER) / propagation->steps_per_m - (lanes){ 0 };
            turn->fan = propagation->fans + propagation->first[item.point];
            turn->end = propagation->fans + propagation->first[item.point + 1];
            if (turn->fan < turn->end)
                return true;
        }
    }
    return false;
}

/* Computes the distances that the current point offers to the neighbours in the current fan. Has one branch only, so that the processor
 * overlaps the computations of several fronts (propagations from different sources). */
SIMD_BODY void look_round(struct front_turn *turn)
{
    const lanes zero = { 0 };
    const struct propagation_fan *fan = turn->fan;
    lanes each, bend, length, cosine, sine, offers;
    for (int i = 0; i < PROPAGATION_FAN; i++)
        each[i] = turn->front->distance_m[fan->to[i]];
    for (int i = 0; i < PROPAGATION_FAN; i++)
        bend[i] = turn->front->bend_m[fan->to[i]];
    memcpy(&length, fan->length_m, sizeof(length));
    memcpy(&cosine, fan->cosine, sizeof(cosine));
    memcpy(&sine, fan->sine, sizeof(sine));
    /* a neighbour may be nearer to the source than this point: in an obtuse triangle, the path to it may pass through the edge
       from this point to a third one that is nearer still */
    mask takes = length >= zero;
    length = (lanes)((mask)length & INT32_MAX);
    offers_of(turn, &each, &length, &cosine, &sine, &bend, &offers);
    takes &= offers < each;
    memcpy(turn->offered_m, &offers, sizeof(offers));
    memcpy(turn->bends_m, &bend, sizeof(bend));
    turn->takes = bits_of(&takes);
}

SIMD_BODY void hand_out(const struct propagation *propagation, struct front_turn *turn)
{
    for (uint32_t left = turn->takes; left; left &= left - 1) {
        int i = __builtin_ctz(left);
        offer(propagation, turn->front, turn->fan->to[i], turn->offered_m[i], turn->bends_m[i]);
    }
}

/* --- near the source ------------------------------------------------------------------------------------------------------------ */

/* An edge as seen from the source, which is at (0, 0) of a plane. From the source, the edge runs counter-clockwise from l to r. The source
 * sees the part of the edge in directions between low and high. */
struct window {
    double l[2], r[2], low[2], high[2];
    /* edge as a side of the triangle behind it, seen from the source: 3 * triangle + side. In that triangle the side runs from r to l */
    uint32_t entered;
};

static double cross(const double a[2], const double b[2])
{
    return a[0] * b[1] - a[1] * b[0];
}

/* Computes the position of the third corner of the triangle behind the window's edge. Even a very short edge keeps its length: with length
 * 0, the corner would lie inside every window, and 2^MAX_DEPTH windows would be followed. */
static void lay_out_apex(const struct window *window, double to_l_m, double to_r_m, double apex[2])
{
    double e[2] = { window->r[0] - window->l[0], window->r[1] - window->l[1] }, length = max_of(hypot(e[0], e[1]), NO_LENGTH);
    double along = (to_l_m * to_l_m - to_r_m * to_r_m + length * length) / (2 * length);
    double off = sqrt(max_of(to_l_m * to_l_m - along * along, 0));
    apex[0] = window->l[0] + (along * e[0] + off * e[1]) / length;
    apex[1] = window->l[1] + (along * e[1] - off * e[0]) / length;
}

static void look_through(const struct propagation *propagation, struct propagation_front *front, const struct window *window, int depth)
{
    const struct intrinsic *in = propagation->in;
    uint32_t t = window->entered / 3, side = window->entered % 3;
    double apex[2];
    if (!(min_of(hypot(window->l[0], window->l[1]), hypot(window->r[0], window->r[1])) < propagation->near_m))
        return;
    lay_out_apex(window, in->lengths[t][(side + 1) % 3], in->lengths[t][(side + 2) % 3], apex);
    double distance_m = hypot(apex[0], apex[1]);
    bool after_low = cross(window->low, apex) >= 0, before_high = cross(apex, window->high) >= 0;
    /* The triangle's third corner divides the window (part of an edge that the source sees) into two narrower ones. It is on neither side
       only if its position is NAN. The windows would then stay as wide, and far too many would be followed. */
    if (!after_low && !before_high)
        return;
    if (after_low && before_high && distance_m < propagation->near_m)
        offer(propagation, front, in->points[t][(side + 2) % 3], (float)distance_m, 0);
    for (uint32_t i = 0; i < 2; i++) {
        struct window next = *window;
        next.entered = in->glue[t][(side + 1 + i) % 3];
        memcpy(i ? next.l : next.r, apex, sizeof(apex));
        if (i ? after_low : before_high)
            memcpy(i ? next.low : next.high, apex, sizeof(apex));
        if (next.entered != TRIMESH_NONE && cross(next.low, next.high) > 0 && depth < MAX_DEPTH)
            look_through(propagation, front, &next, depth + 1);
    }
}

/* a triangle unfolded into a plane in which the source is at (0, 0) */
struct laid {
    uint32_t tri; /* index in the intrinsic triangulation */
    double corners[3][2];
};

/* Unfolds the triangle that contains the source into the plane, if the intrinsic triangulation still has this triangle. given: its corners
   in the mesh. Returns false if one of its edges was flipped. */
static bool lay_out_kept(const struct intrinsic *in, const uint32_t given[3], uint32_t tri, const double weights[3], struct laid *laid)
{
    const uint32_t *v = in->points[tri];
    double source[2] = { 0 };
    *laid = (struct laid){ tri, { { 0, 0 }, { in->lengths[tri][0], 0 } } };
    intrinsic_layout(in->lengths[tri], &laid->corners[2][0], &laid->corners[2][1]);
    for (int i = 0; i < 3; i++) {
        int same = v[i] == given[0] ? 0 : v[i] == given[1] ? 1 : v[i] == given[2] ? 2 : -1;
        if (same < 0)
            return false;
        source[0] += weights[same] * laid->corners[i][0];
        source[1] += weights[same] * laid->corners[i][1];
    }
    for (int i = 0; i < 3; i++)
        for (int axis = 0; axis < 2; axis++)
            laid->corners[i][axis] -= source[axis];
    return true;
}

/* Follows a straight line from the middle of the window's edge to the point `to` behind the edge, triangle by triangle. Each triangle
 * entered changes the window to the edge that the line crossed. apex: third corner of the last triangle. Returns false if the surface ends
 * before `to`, or after MAX_DEPTH triangles. */
static bool walk_to(const struct intrinsic *in, const double to[2], struct window *window, double apex[2])
{
    const double from[2] = { (window->l[0] + window->r[0]) / 2, (window->l[1] + window->r[1]) / 2 };
    const double way[2] = { to[0] - from[0], to[1] - from[1] };
    for (int depth = 0; depth < MAX_DEPTH; depth++) {
        uint32_t t = window->entered / 3, side = window->entered % 3;
        lay_out_apex(window, in->lengths[t][(side + 1) % 3], in->lengths[t][(side + 2) % 3], apex);
        bool passes_l = cross(way, (const double[2]){ apex[0] - from[0], apex[1] - from[1] }) > 0;
        /* position of the triangle's corner between the side where the line entered and the side where it leaves */
        const double *end = passes_l ? window->l : window->r;
        double along[2] = { apex[0] - end[0], apex[1] - end[1] }, beyond[2] = { to[0] - end[0], to[1] - end[1] };
        if (passes_l ? cross(along, beyond) >= 0 : cross(beyond, along) >= 0)
            return true;
        window->entered = in->glue[t][(side + (passes_l ? 1 : 2)) % 3];
        memcpy(passes_l ? window->r : window->l, apex, sizeof(window->r));
        if (window->entered == TRIMESH_NONE)
            return false;
    }
    return false;
}

/* Computes the position in the plane, with y >= 0, of the point at distance to_r_m from r, which is at (0, 0), and to_l_m from l,
   which is at (side, 0). */
static void place_above(double side, double to_r_m, double to_l_m, double out[2])
{
    intrinsic_layout((const double[3]){ side, to_l_m, to_r_m }, &out[0], &out[1]);
}

/* Unfolds the intrinsic triangle that contains the source into the plane, where edges of the mesh triangle around the source
   were flipped. Starts at side `entered`, which this mesh triangle shares with the intrinsic triangulation. To check that the
   intrinsic triangles cover the mesh triangle, follows a straight line to the mesh triangle's third corner. Returns false if
   they do not; then another side must be tried. */
static bool lay_out_beyond(const struct propagation *propagation, uint32_t entered, uint32_t third, const double source[3],
                           struct laid *laid)
{
    const struct intrinsic *in = propagation->in;
    const double(*points)[3] = (const double(*)[3])propagation->mesh->points;
    uint32_t t = entered / 3, side = entered % 3, r = in->points[t][side], l = in->points[t][(side + 1) % 3];
    const struct window first = { .l = { in->lengths[t][side], 0 }, .entered = entered };
    double at[2], corner[2], beside[2], apex[2];
    place_above(first.l[0], vec_distance(points[r], points[third]), vec_distance(points[l], points[third]), corner);
    place_above(first.l[0], vec_distance(points[r], source), vec_distance(points[l], source), at);
    beside[0] = corner[0] + CORNER_OFFSET * (first.l[0] / 2 - corner[0]);
    beside[1] = corner[1] - CORNER_OFFSET * corner[1];
    struct window window = first;
    if (!walk_to(in, beside, &window, apex) || in->points[window.entered / 3][(window.entered + 2) % 3] != third ||
        hypot(apex[0] - corner[0], apex[1] - corner[1]) > CORNER_OFFSET * first.l[0])
        return false;
    window = first;
    if (!walk_to(in, at, &window, apex))
        return false;
    laid->tri = window.entered / 3;
    side = window.entered % 3;
    for (int axis = 0; axis < 2; axis++) {
        laid->corners[side][axis] = window.r[axis] - at[axis];
        laid->corners[(side + 1) % 3][axis] = window.l[axis] - at[axis];
        laid->corners[(side + 2) % 3][axis] = apex[axis] - at[axis];
    }
    return true;
}

static bool lay_out_flipped(const struct propagation *propagation, const uint32_t given[3], const double source[3], struct laid *laid)
{
    const struct intrinsic *in = propagation->in;
    for (uint32_t t = 0; t < in->tri_count; t++)
        for (uint32_t side = 0; side < 3; side++) {
            uint32_t p = in->points[t][side], q = in->points[t][(side + 1) % 3], third = TRIMESH_NONE;
            for (int i = 0; i < 3; i++)
                if ((p == given[i] && q == given[(i + 1) % 3]) || (q == given[i] && p == given[(i + 1) % 3]))
                    third = given[(i + 2) % 3];
            if (third != TRIMESH_NONE && lay_out_beyond(propagation, 3 * t + side, third, source, laid))
                return true;
        }
    return false;
}

/* Returns whether an intrinsic triangle is flat in space and contains the source. parts: receives the source's barycentric weights;
   off_m: its distance from the triangle's plane. */
static bool lies_in(const struct propagation *propagation, uint32_t t, const double source[3], double parts[3], double *off_m)
{
    const struct intrinsic *in = propagation->in;
    const double *sides = in->lengths[t], longest_m = max_of(sides[0], max_of(sides[1], sides[2]));
    const double *corners[3];
    double normal[3], to[3], turned[3], rounding_m = 0;
    for (int i = 0; i < 3; i++) {
        corners[i] = propagation->mesh->points[in->points[t][i]];
        rounding_m = max_of(rounding_m, ROUNDING * fabs(source[i]));
    }
    if (vec_distance(source, corners[0]) > longest_m)
        return false;
    for (int i = 0; i < 3; i++)
        if (fabs(vec_distance(corners[i], corners[(i + 1) % 3]) - sides[i]) > BENT * longest_m + 4 * in->lengthened_m + rounding_m)
            return false;
    vec_normal(corners[0], corners[1], corners[2], normal);
    double square = vec_dot(normal, normal);
    if (!(square > 0))
        return false;
    vec_sub(source, corners[0], to);
    *off_m = fabs(vec_dot(to, normal)) / sqrt(square);
    for (int i = 0; i < 3; i++) {
        vec_normal(source, corners[(i + 1) % 3], corners[(i + 2) % 3], turned);
        parts[i] = vec_dot(turned, normal) / square;
    }
    return min_of(parts[0], min_of(parts[1], parts[2])) >= -OUTSIDE && *off_m <= OFF_PLANE * longest_m + rounding_m;
}

/* Unfolds the intrinsic triangle that contains the source into the plane, if all edges of the mesh triangle around the source were
   flipped. Searches the source's patch from mesh triangle `tri` on, because another surface can be very close. Takes the triangle
   whose plane is nearest. Returns false if there is none, or when out of memory. */
static bool lay_out_in_space(const struct propagation *propagation, uint32_t tri, const double source[3], struct laid *laid)
{
    const struct intrinsic *in = propagation->in;
    uint32_t *queue = mem_try_array(in->tri_count, sizeof(*queue));
    uint8_t *seen = mem_try_array(in->tri_count, 1);
    double least_m = INFINITY;
    size_t count = 0;
    if (queue && seen) {
        queue[count++] = tri;
        seen[tri] = 1;
    }
    for (size_t at = 0; at < count; at++) {
        uint32_t t = queue[at];
        double parts[3], off_m, x, y, sum = 0;
        for (int i = 0; i < 3; i++)
            if (in->glue[t][i] != TRIMESH_NONE && !seen[in->glue[t][i] / 3]) {
                seen[in->glue[t][i] / 3] = 1;
                queue[count++] = in->glue[t][i] / 3;
            }
        if (!lies_in(propagation, t, source, parts, &off_m) || off_m >= least_m)
            continue;
        least_m = off_m;
        for (int i = 0; i < 3; i++)
            sum += parts[i] = max_of(parts[i], MIN_WEIGHT);
        /* the triangle's corners are (0, 0), (length of side 0, 0) and (x, y) */
        intrinsic_layout(in->lengths[t], &x, &y);
        double side = in->lengths[t][0], at_x = (parts[1] * side + parts[2] * x) / sum, at_y = parts[2] * y / sum;
        *laid = (struct laid){ t, { { -at_x, -at_y }, { side - at_x, -at_y }, { x - at_x, y - at_y } } };
    }
    mem_free(queue);
    mem_free(seen);
    return least_m < INFINITY;
}

/* Sets the exact distances of points near the source that a straight line on the unfolded surface reaches. Propagation alone
   would be wrong there. A ray may pass between two points that are farther from the source than the ray's end, and are
   therefore processed after it. */
static void look_around(const struct propagation *propagation, struct propagation_front *front, uint32_t tri, const double weights[3])
{
    const struct intrinsic *in = propagation->in;
    const uint32_t *given = propagation->mesh->tris[tri];
    double inside[3], source[3] = { 0 }, sum = 0;
    struct laid laid;
    for (int i = 0; i < 3; i++)
        sum += max_of(weights[i], MIN_WEIGHT);
    for (int i = 0; i < 3; i++)
        inside[i] = max_of(weights[i], MIN_WEIGHT) / sum;
    for (int i = 0; i < 3; i++)
        for (int axis = 0; axis < 3; axis++)
            source[axis] += inside[i] * propagation->mesh->points[given[i]][axis];
    if (!lay_out_kept(in, given, tri, inside, &laid) && !lay_out_flipped(propagation, given, source, &laid) &&
        !lay_out_in_space(propagation, tri, source, &laid))
        return;
    for (int i = 0; i < 3; i++) {
        struct window window = { .entered = in->glue[laid.tri][i] };
        offer(propagation, front, in->points[laid.tri][i], (float)hypot(laid.corners[i][0], laid.corners[i][1]), 0);
        memcpy(window.l, laid.corners[i], sizeof(window.l));
        memcpy(window.r, laid.corners[(i + 1) % 3], sizeof(window.r));
        memcpy(window.low, window.l, sizeof(window.low));
        memcpy(window.high, window.r, sizeof(window.high));
        if (window.entered != TRIMESH_NONE)
            look_through(propagation, front, &window, 0);
    }
}

/* Computes the straight-line distances from the source to all points in advance. Offers access points in random order, where
 * computing them would wait for memory. */
SIMD_BODY void measure_straight(const struct trimesh *mesh, struct propagation_front *front)
{
    const double q[3] = { front->source_m[0], front->source_m[1], front->source_m[2] }, (*points)[3] = (const double(*)[3])mesh->points;
    float *restrict straight_m = front->straight_m;
    for (size_t i = 0; i < mesh->point_count; i++) {
        double x = points[i][0] - q[0], y = points[i][1] - q[1], z = points[i][2] - q[2];
        straight_m[i] = (float)sqrt(x * x + y * y + z * z);
    }
}

/* Propagates distances from the points in the buckets of `count` fronts, until all buckets are empty. Takes one fan of each front in turn.
 * Each fan of a front depends on the results of the previous fan; alternating between independent fronts hides that latency. */
SIMD_BODY void propagate_fronts(const struct propagation *propagation, struct propagation_front *fronts, size_t count)
{
    struct front_turn turns[PROPAGATION_ABREAST] = { { 0 } };
    size_t left = 0;
    for (size_t i = 0; i < count; i++) {
        turns[left].front = &fronts[i];
        turns[left].empty = 0;
        left += next_point(propagation, &turns[left]);
    }
    while (left > 0) {
        for (size_t i = 0; i < left; i++)
            look_round(&turns[i]);
        for (size_t i = left; i-- > 0;) {
            hand_out(propagation, &turns[i]);
            if (++turns[i].fan == turns[i].end && !next_point(propagation, &turns[i]))
                turns[i] = turns[--left];
        }
    }
}

static void measure_straight_plain(const struct trimesh *mesh, struct propagation_front *front)
{
    measure_straight(mesh, front);
}

SIMD_AVX2 static void measure_straight_wide(const struct trimesh *mesh, struct propagation_front *front)
{
    measure_straight(mesh, front);
}

static void propagate_fronts_plain(const struct propagation *propagation, struct propagation_front *fronts, size_t count)
{
    propagate_fronts(propagation, fronts, count);
}

SIMD_AVX2 static void propagate_fronts_wide(const struct propagation *propagation, struct propagation_front *fronts, size_t count)
{
    propagate_fronts(propagation, fronts, count);
}

static bool set_out(const struct propagation *propagation, struct propagation_front *front, uint32_t tri, const double weights[3])
{
    const struct trimesh *mesh = propagation->mesh;
    const uint32_t *v = mesh->tris[tri];
    if (!clear(propagation, front))
        return false;
    for (int axis = 0; axis < 3; axis++)
        front->source_m[axis] =
            weights[0] * mesh->points[v[0]][axis] + weights[1] * mesh->points[v[1]][axis] + weights[2] * mesh->points[v[2]][axis];
    (simd_has_avx2() ? measure_straight_wide : measure_straight_plain)(mesh, front);
    for (int i = 0; i < 3; i++)
        offer(propagation, front, v[i], (float)vec_distance(front->source_m, mesh->points[v[i]]), 0);
    look_around(propagation, front, tri, weights);
    return true;
}

bool propagation_run(const struct propagation *propagation, struct propagation_front *fronts, const struct propagation_source *sources,
                     size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!set_out(propagation, &fronts[i], sources[i].tri, sources[i].weights))
            return false;
    (simd_has_avx2() ? propagate_fronts_wide : propagate_fronts_plain)(propagation, fronts, count);
    return true;
}
