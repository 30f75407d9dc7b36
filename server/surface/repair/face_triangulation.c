/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inserts points, and edges between these points, into the triangulation of one face of the mesh (face_triangulation.h). */
#include "surface/repair/face_triangulation.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"

#define ON_EDGE 1e-9 /* a point counts as on an edge of the face if its barycentric weight for the opposite corner is at most this */
#define ON_WAY 1e-6  /* a point within this distance of a straight line, relative to the line's length, counts as on the line */

void face_triangulation_finish(struct face_triangulation *face)
{
    mem_free(face->ids);
    mem_free(face->at);
    mem_free(face->tris);
    *face = (struct face_triangulation){ 0 };
}

uint32_t face_triangulation_add_point(struct face_triangulation *face, uint32_t id, double x, double y)
{
    mem_grow(&face->ids, &face->capacity, face->count + 1, sizeof(*face->ids));
    mem_grow(&face->at, &face->at_capacity, face->count + 1, sizeof(*face->at));
    face->ids[face->count] = id;
    face->at[face->count][0] = x;
    face->at[face->count][1] = y;
    return (uint32_t)face->count++;
}

void face_triangulation_add_tri(struct face_triangulation *face, uint32_t a, uint32_t b, uint32_t c)
{
    mem_grow(&face->tris, &face->tri_capacity, face->tri_count + 1, sizeof(*face->tris));
    memcpy(face->tris[face->tri_count++], (const uint32_t[3]){ a, b, c }, sizeof(*face->tris));
}

static double twice_area(const struct face_triangulation *face, uint32_t a, uint32_t b, uint32_t c)
{
    const double *p = face->at[a], *q = face->at[b], *r = face->at[c];
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
}

/* Returns the index of the triangle of the face's triangulation that contains a point: the one where the smallest of the
 * point's barycentric weights is largest. */
static size_t locate(const struct face_triangulation *face, uint32_t point, double weights[3])
{
    size_t best = 0;
    double best_weight = -INFINITY;
    for (size_t t = 0; t < face->tri_count; t++) {
        const uint32_t *v = face->tris[t];
        double area = twice_area(face, v[0], v[1], v[2]), w[3];
        if (!(fabs(area) > 0))
            continue;
        for (int i = 0; i < 3; i++)
            w[i] = twice_area(face, point, v[(i + 1) % 3], v[(i + 2) % 3]) / area;
        double least = min_of(w[0], min_of(w[1], w[2]));
        if (least > best_weight) {
            best_weight = least;
            best = t;
            memcpy(weights, w, sizeof(w));
        }
    }
    return best;
}

/* Splits every triangle of the face's triangulation that has the side u-v in two, at `point`. */
static void split_side(struct face_triangulation *face, uint32_t u, uint32_t v, uint32_t point)
{
    size_t count = face->tri_count;
    for (size_t t = 0; t < count; t++)
        for (int i = 0; i < 3; i++) {
            uint32_t a = face->tris[t][i], b = face->tris[t][(i + 1) % 3], c = face->tris[t][(i + 2) % 3];
            if (!((a == u && b == v) || (a == v && b == u)))
                continue;
            memcpy(face->tris[t], (const uint32_t[3]){ a, point, c }, sizeof(*face->tris));
            face_triangulation_add_tri(face, point, b, c);
            break;
        }
}

void face_triangulation_insert(struct face_triangulation *face, uint32_t point)
{
    double w[3] = { 0 };
    size_t t = locate(face, point, w);
    uint32_t v[3];
    memcpy(v, face->tris[t], sizeof(v));
    for (int i = 0; i < 3; i++)
        if (w[i] < ON_EDGE) {
            split_side(face, v[(i + 1) % 3], v[(i + 2) % 3], point);
            return;
        }
    memcpy(face->tris[t], (const uint32_t[3]){ v[0], v[1], point }, sizeof(*face->tris));
    face_triangulation_add_tri(face, v[1], v[2], point);
    face_triangulation_add_tri(face, v[2], v[0], point);
}

/* --- sides between points ------------------------------------------------------------------------------------------------------ */

struct crossed { /* list of sides of triangles that a straight line crosses, in the order of crossing */
    uint32_t (*sides)[2];
    size_t count, capacity;
};

static void add_crossed(struct crossed *crossed, uint32_t a, uint32_t b)
{
    mem_grow(&crossed->sides, &crossed->capacity, crossed->count + 1, sizeof(*crossed->sides));
    memcpy(crossed->sides[crossed->count++], (const uint32_t[2]){ a, b }, sizeof(*crossed->sides));
}

/* Returns the index of the triangle with the side from a to b, and its third corner in *apex; tri_count: there is none. */
static size_t find_side(const struct face_triangulation *face, uint32_t a, uint32_t b, uint32_t *apex)
{
    for (size_t t = 0; t < face->tri_count; t++)
        for (int i = 0; i < 3; i++)
            if (face->tris[t][i] == a && face->tris[t][(i + 1) % 3] == b) {
                *apex = face->tris[t][(i + 2) % 3];
                return t;
            }
    return face->tri_count;
}

/* Returns whether a point lies on the straight segment from u to v, excluding u but including v. */
static bool is_passed(const struct face_triangulation *face, uint32_t u, uint32_t v, uint32_t point)
{
    const double *p = face->at[u], *q = face->at[v], *r = face->at[point];
    double x = q[0] - p[0], y = q[1] - p[1], length2 = x * x + y * y, along = (r[0] - p[0]) * x + (r[1] - p[1]) * y;
    return point == v || (along > ON_WAY * length2 && along < length2 && fabs(twice_area(face, u, v, point)) < ON_WAY * length2);
}

/* Follows the line from u to v until it ends or passes over a point, and lists the crossed sides. Returns v or the point passed over; u if
 * the line cannot be followed. */
static uint32_t follow_line(const struct face_triangulation *face, uint32_t u, uint32_t v, struct crossed *crossed)
{
    uint32_t right = u, left = u, apex;
    for (size_t t = 0; t < face->tri_count; t++)
        for (int i = 0; i < 3; i++) {
            uint32_t a = face->tris[t][(i + 1) % 3], b = face->tris[t][(i + 2) % 3];
            if (face->tris[t][i] != u)
                continue;
            if (is_passed(face, u, v, a) || is_passed(face, u, v, b))
                return is_passed(face, u, v, a) ? a : b;
            if (twice_area(face, u, v, a) < 0 && twice_area(face, u, v, b) > 0) {
                right = a;
                left = b;
            }
        }
    /* limits the number of steps, because rounding errors in flat triangles might lead to an endless loop */
    while (right != left && crossed->count < face->tri_count) {
        add_crossed(crossed, right, left);
        if (find_side(face, left, right, &apex) == face->tri_count)
            return u;
        if (is_passed(face, u, v, apex))
            return apex;
        if (twice_area(face, u, v, apex) < 0)
            right = apex;
        else
            left = apex;
    }
    return u;
}

/* Flips the side from a to b to the other diagonal of its two triangles. turned[] receives the ends of that diagonal. Returns
 * false if the triangles do not form a convex quadrilateral. */
static bool flip_side(struct face_triangulation *face, const uint32_t side[2], uint32_t turned[2])
{
    uint32_t a = side[0], b = side[1], c = a, d = a;
    size_t one = find_side(face, a, b, &c), other = find_side(face, b, a, &d);
    if (one == face->tri_count || other == face->tri_count || !(twice_area(face, a, d, c) > 0) || !(twice_area(face, d, b, c) > 0))
        return false;
    memcpy(face->tris[one], (const uint32_t[3]){ a, d, c }, sizeof(*face->tris));
    memcpy(face->tris[other], (const uint32_t[3]){ d, b, c }, sizeof(*face->tris));
    turned[0] = c;
    turned[1] = d;
    return true;
}

static bool is_crossed(const struct face_triangulation *face, uint32_t u, uint32_t v, const uint32_t side[2])
{
    if (side[0] == u || side[0] == v || side[1] == u || side[1] == v)
        return false;
    return (twice_area(face, u, v, side[0]) > 0) != (twice_area(face, u, v, side[1]) > 0);
}

/* Makes u-v an edge by flipping the sides that cross the line from u to v, until none is left (Sloan 1993). */
void face_triangulation_connect(struct face_triangulation *face, uint32_t u, uint32_t v)
{
    struct crossed crossed = { 0 };
    size_t steps = 0;
    for (uint32_t end; u != v && steps++ < face->count; u = end) {
        crossed.count = 0;
        end = follow_line(face, u, v, &crossed);
        if (end == u)
            break;
        for (size_t i = 0, most = 4 * crossed.count * crossed.count; i < crossed.count && i < most; i++) {
            uint32_t side[2] = { crossed.sides[i][0], crossed.sides[i][1] }, turned[2];
            if (!flip_side(face, side, turned))
                add_crossed(&crossed, side[0], side[1]);
            else if (is_crossed(face, u, end, turned))
                add_crossed(&crossed, turned[0], turned[1]);
        }
    }
    mem_free(crossed.sides);
}
