/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prepares a mesh for computing geodesic distances, which pass from each point to its neighbours. Lists the neighbours and
   triangles around each point in angular order (its fans). */
#include "surface/geodesic/propagation.h"

#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"

/* number of buckets of the priority queue per mean edge length. Points in one bucket are processed in any order, so buckets
   must be shorter than most edges, even in meshes with many needle-shaped triangles. On such a mesh, 32 instead of 512 buckets
   made mean errors 2 to 3 times as large. */
#define STEPS_PER_EDGE 512.0
#define NEAR_EDGES 5.0
#define MAX_BUCKETS (1u << 16)
/* The triangles around a point are lined up in rows of triangles that are each adjacent to the next. This is the maximum number
   of triangles tested to find the next one of a row; if none is adjacent, the row ends. */
#define MAX_TRIED 64
/* smallest angle, in radians, by which the triangles around a point exceed a full turn if paths bend there; smaller ones are
   rounding */
#define MIN_BEND 1e-6
/* largest excess of the angle around a point inside the surface, in radians, with which the bend's radius is known. Larger ones occur
   where parts intersect, at corners whose positions depend on the triangles. */
#define MAX_SADDLE 0.1

/* Returns the corners of triangle t: a triangle of the intrinsic triangulation, or, for indices after those, an interior (hidden) triangle.
 * tri_sides() writes its side lengths, from corner i to corner i + 1. */
static const uint32_t *tri_points(const struct propagation *propagation, const struct intrinsic *in, size_t t)
{
    return t < in->tri_count ? in->points[t] : propagation->mesh->tris[t];
}

static void tri_sides(const struct propagation *propagation, const struct intrinsic *in, size_t t, double sides[3])
{
    const uint32_t *v = tri_points(propagation, in, t);
    for (int i = 0; i < 3; i++)
        sides[i] = t < in->tri_count ? in->lengths[t][i]
                                     : vec_distance(propagation->mesh->points[v[i]], propagation->mesh->points[v[(i + 1) % 3]]);
}

/* --- fans ---------------------------------------------------------------------------------------------------------------------- */

struct end { /* other end, and length, of a triangle's side that begins at the point whose fan is being built */
    uint32_t to;
    float length_m; /* as in struct propagation_fan */
};

struct vertex_wedge { /* wedge: a triangle with a corner at the current point: its two sides there, and the angle between them */
    struct end ends[2];
    float cosine, sine;
};

static struct vertex_wedge wedge_of(const struct propagation *propagation, const struct intrinsic *in, size_t t, int corner)
{
    const uint32_t *v = tri_points(propagation, in, t);
    bool inside = t >= in->tri_count;
    double sides[3];
    tri_sides(propagation, in, t, sides);
    double to_a = sides[corner], to_b = sides[(corner + 2) % 3], across = sides[(corner + 1) % 3];
    double cosine = min_of(max_of((to_a * to_a + to_b * to_b - across * across) / (2 * to_a * to_b), -1), 1);
    uint32_t a = v[(corner + 1) % 3], b = v[(corner + 2) % 3];
    return (struct vertex_wedge){ { { a, (float)(inside && !propagation->hidden[a] ? -to_a : to_a) },
                                    { b, (float)(inside && !propagation->hidden[b] ? -to_b : to_b) } },
                                  (float)cosine,
                                  (float)sqrt(1 - cosine * cosine) };
}

static void turn_round(struct vertex_wedge *wedge)
{
    struct end swap = wedge->ends[0];
    wedge->ends[0] = wedge->ends[1];
    wedge->ends[1] = swap;
}

/* Extends a row of adjacent triangles (wedges) around a point; the first `count` wedges form the row. Repeatedly moves a wedge
   adjacent to the row's end to that end, until no adjacent one is left. Returns the new number of wedges in the row. */
static size_t extend(struct vertex_wedge *wedges, size_t count, size_t all)
{
    for (size_t i = count; i < all && i < count + MAX_TRIED; i++)
        for (int end = 0; end < 2; end++) {
            const struct end *last = &wedges[count - 1].ends[1];
            if (wedges[i].ends[end].to != last->to || wedges[i].ends[end].length_m != last->length_m)
                continue;
            struct vertex_wedge next = wedges[i];
            wedges[i] = wedges[count];
            wedges[count] = next;
            if (end == 1)
                turn_round(&wedges[count]);
            i = count++;
            break;
        }
    return count;
}

static void reverse(struct vertex_wedge *wedges, size_t count)
{
    for (size_t i = 0; i < (count + 1) / 2; i++) {
        struct vertex_wedge swap = wedges[i];
        wedges[i] = wedges[count - 1 - i];
        wedges[count - 1 - i] = swap;
    }
    for (size_t i = 0; i < count; i++)
        turn_round(&wedges[i]);
}

static struct propagation_fan *add_fan(struct propagation *propagation, uint32_t point)
{
    mem_grow(&propagation->fans, &propagation->fan_capacity, propagation->fan_count + 1, sizeof(*propagation->fans));
    struct propagation_fan *fan = &propagation->fans[propagation->fan_count++];
    for (int i = 0; i < PROPAGATION_FAN; i++) {
        fan->to[i] = point;
        fan->length_m[i] = INFINITY;
        fan->cosine[i] = fan->sine[i] = 0;
    }
    return fan;
}

/* Appends a row of adjacent wedges (triangles around a point) to the point's fans. A fan has PROPAGATION_FAN lanes, one per neighbour; the
 * neighbour in the last lane of a full fan is stored again in the next fan. lane: number of lanes used in the last fan. Returns the number
 * used afterwards. */
static int add_row(struct propagation *propagation, uint32_t point, const struct vertex_wedge *row, size_t count, int lane)
{
    for (size_t i = 0; i <= count; i++) {
        const struct end *end = i < count ? &row[i].ends[0] : &row[count - 1].ends[1];
        for (bool again = true; again;) {
            struct propagation_fan *fan =
                lane == PROPAGATION_FAN ? add_fan(propagation, point) : &propagation->fans[propagation->fan_count - 1];
            lane = lane == PROPAGATION_FAN ? 0 : lane;
            again = lane == PROPAGATION_FAN - 1 && i < count;
            fan->to[lane] = end->to;
            fan->length_m[lane] = end->length_m;
            fan->cosine[lane] = i < count && !again ? row[i].cosine : 0;
            fan->sine[lane++] = i < count && !again ? row[i].sine : 0;
        }
    }
    return lane;
}

/* Returns the radius of the arc around which shortest paths bend at a point, from the `count` adjacent triangles around it: the
   distance to its neighbours divided by the angle that exceeds a full turn (at the border of the surface, half a turn), less that
   distance. At a corner of the border, with an excess of one radian or more, the radius is 0. */
static float bend_radius(const struct vertex_wedge *wedges, size_t count)
{
    const struct end *first = &wedges[0].ends[0], *last = &wedges[count - 1].ends[1];
    const bool is_closed = count > 2 && first->to == last->to && first->length_m == last->length_m;
    double angle = is_closed ? -2 * M_PI : -M_PI, length_m = 0;
    for (size_t i = 0; i < count; i++) {
        angle += acos((double)wedges[i].cosine);
        length_m += fabs((double)wedges[i].ends[0].length_m) / (double)count;
    }
    if (!is_closed)
        length_m = (fabs((double)first->length_m) + fabs((double)last->length_m)) / 2;
    return angle > MIN_BEND && (!is_closed || angle < MAX_SADDLE) ? (float)(length_m * max_of(1 / angle - 1, 0)) : PROPAGATION_NO_BEND;
}

static void add_fans(struct propagation *propagation, uint32_t point, struct vertex_wedge *wedges, size_t count)
{
    int lane = PROPAGATION_FAN;
    for (size_t begin = 0, row; begin < count; begin += row) {
        row = extend(wedges + begin, 1, count - begin);
        reverse(wedges + begin, row);
        row = extend(wedges + begin, row, count - begin);
        /* paths that bend from one row to another are rare, and their bends are not known */
        propagation->bend_radius_m[point] = row == count ? bend_radius(wedges, count) : PROPAGATION_NO_BEND;
        lane = add_row(propagation, point, wedges + begin, row, lane);
    }
}

/* Returns the index at which each point's triangles begin in a list sorted by point: the number of triangle corners at points
 * of lower index. An extra element at the end holds the total. The caller frees the array. */
static uint32_t *count_corners(const struct propagation *propagation, const struct intrinsic *in)
{
    size_t points = propagation->mesh->point_count;
    uint32_t *first = mem_array(points + 2, sizeof(*first));
    for (size_t t = 0; t < propagation->mesh->tri_count; t++)
        for (int i = 0; i < 3; i++)
            first[tri_points(propagation, in, t)[i] + 2]++;
    for (size_t p = 2; p < points + 2; p++)
        first[p] += first[p - 1];
    return first;
}

static void make_fans(struct propagation *propagation, const struct intrinsic *in)
{
    size_t points = propagation->mesh->point_count, tris = propagation->mesh->tri_count, most = 0;
    uint32_t *first = count_corners(propagation, in), *corners = mem_array(3 * tris, sizeof(*corners));
    for (uint32_t t = 0; t < tris; t++)
        for (uint32_t i = 0; i < 3; i++)
            corners[first[tri_points(propagation, in, t)[i] + 1]++] = 3 * t + i;
    for (size_t p = 0; p < points; p++)
        most = first[p + 1] - first[p] > most ? first[p + 1] - first[p] : most;
    struct vertex_wedge *wedges = mem_array(most, sizeof(*wedges));
    for (uint32_t p = 0; p < points; p++) {
        size_t count = first[p + 1] - first[p];
        for (size_t i = 0; i < count; i++)
            wedges[i] = wedge_of(propagation, in, corners[first[p] + i] / 3, (int)(corners[first[p] + i] % 3));
        propagation->first[p] = (uint32_t)propagation->fan_count;
        add_fans(propagation, p, wedges, count);
    }
    propagation->first[points] = (uint32_t)propagation->fan_count;
    mem_free(wedges);
    mem_free(corners);
    mem_free(first);
}

/* Chooses the number of buckets, which form a ring buffer. The ring must span the longest edge and near_m, because a new distance exceeds
   the current one by at most that much. */
static void choose_buckets(struct propagation *propagation, const struct intrinsic *in)
{
    double sum = 0, longest = 0, sides[3];
    for (size_t t = 0; t < propagation->mesh->tri_count; t++) {
        tri_sides(propagation, in, t, sides);
        sum += sides[0] + sides[1] + sides[2];
        longest = max_of(longest, max_of(sides[0], max_of(sides[1], sides[2])));
    }
    double step_m = max_of(sum / (3 * (double)propagation->mesh->tri_count * STEPS_PER_EDGE), longest / (MAX_BUCKETS - 4));
    propagation->steps_per_m = (float)(1 / step_m);
    propagation->bucket_count = 8;
    propagation->near_m = NEAR_EDGES * sum / (3 * (double)propagation->mesh->tri_count);
    while (propagation->bucket_count < max_of(longest, propagation->near_m) / step_m + 4)
        propagation->bucket_count *= 2;
}

void propagation_init(struct propagation *propagation, const struct trimesh *mesh, size_t visible_count, const struct intrinsic *in)
{
    *propagation = (struct propagation){ .mesh = mesh, .in = in };
    propagation->hidden = mem_array(mesh->point_count, 1);
    propagation->bend_radius_m = mem_array(mesh->point_count, sizeof(*propagation->bend_radius_m));
    propagation->first = mem_array(mesh->point_count + 1, sizeof(*propagation->first));
    memset(propagation->hidden, 1, mesh->point_count);
    for (size_t t = 0; t < visible_count; t++)
        for (int i = 0; i < 3; i++)
            propagation->hidden[mesh->tris[t][i]] = 0;
    make_fans(propagation, in);
    choose_buckets(propagation, in);
}

void propagation_finish(struct propagation *propagation)
{
    mem_free(propagation->first);
    mem_free(propagation->fans);
    mem_free(propagation->hidden);
    mem_free(propagation->bend_radius_m);
    *propagation = (struct propagation){ 0 };
}
