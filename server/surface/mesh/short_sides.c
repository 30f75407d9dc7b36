/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Merges points at short sides of needle-shaped triangles (short_sides.h), in rounds. In each round, no two merged points share a
   triangle. */
#include "surface/mesh/short_sides.h"

#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"

#define SHORT_OF_SIZE 0.005 /* sides longer than this fraction of the model's size are kept; sampling divides them anyway */
#define NEEDLE 16           /* a triangle is a needle if its longest side is at least this many times as long as its shortest */
/* A merge may displace the surface by this fraction of the merged side's length. Circles of 628 and more sides are merged to
   at least 157 sides, fewer sides are kept. */
#define MAX_DISPLACED 0.01
#define SHORT_SIDES_OF_TOLERANCE 0.1 /* the surface moves by at most this fraction of the asset's tolerance */
#define MAX_STAR 48 /* maximum number of triangles around a merged point, and around the point that it is merged with */
#define MAX_ROUNDS 16

struct merging {
    struct trimesh *mesh;
    double short_m, within_m;
    uint32_t *plane, *target;
    /* triangles around each point: first: by point, index in `tris` of its first triangle, with an additional element at the end */
    uint32_t *first, *tris;
    float *moved_m; /* by point: upper bound of the displacement of the surface around the point, by all merges so far */
    char *is_short, *locked;
};

struct merge_star { /* triangles around a point */
    const uint32_t *tris;
    uint32_t point, around[2 * MAX_STAR], faces[2 * MAX_STAR]; /* faces: by neighbour: number of triangles at the edge */
    size_t tri_count, around_count, border_count;
};

static const double *point_of(const struct merging *merging, uint32_t point)
{
    return merging->mesh->points[point];
}

static double length_of(const struct merging *merging, uint32_t a, uint32_t b)
{
    return vec_distance(point_of(merging, a), point_of(merging, b));
}

static double longest_of(const struct merging *merging, uint32_t tri)
{
    const uint32_t *v = merging->mesh->tris[tri];
    return max_of(length_of(merging, v[0], v[1]), max_of(length_of(merging, v[1], v[2]), length_of(merging, v[2], v[0])));
}

/* Marks the ends of short sides of needles. Returns whether there are any. */
static bool mark_short(const struct merging *merging)
{
    const struct trimesh *mesh = merging->mesh;
    bool any = false;
    memset(merging->is_short, 0, mesh->point_count);
    for (size_t t = 0; t < mesh->tri_count; t++) {
        const double longest_m = longest_of(merging, (uint32_t)t);
        for (int i = 0; i < 3; i++) {
            uint32_t a = mesh->tris[t][i], b = mesh->tris[t][(i + 1) % 3];
            if (length_of(merging, a, b) > min_of(merging->short_m, longest_m / NEEDLE))
                continue;
            merging->is_short[a] = merging->is_short[b] = 1;
            any = true;
        }
    }
    return any;
}

static void list_tris(const struct merging *merging)
{
    const struct trimesh *mesh = merging->mesh;
    uint32_t *first = merging->first;
    memset(first, 0, (mesh->point_count + 2) * sizeof(*first));
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++)
            first[mesh->tris[t][i] + 2]++;
    for (size_t p = 2; p < mesh->point_count + 2; p++)
        first[p] += first[p - 1];
    for (uint32_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++)
            merging->tris[first[mesh->tris[t][i] + 1]++] = t;
}

static size_t place_in(const struct merge_star *star, uint32_t point)
{
    size_t i = 0;
    while (i < star->around_count && star->around[i] != point)
        i++;
    return i;
}

/* Collects the triangles and neighbours of a point. Returns false if they do not form a disc, or are too many. */
static bool collect_star(const struct merging *merging, uint32_t point, struct merge_star *star)
{
    star->point = point;
    star->tris = merging->tris + merging->first[point];
    star->tri_count = merging->first[point + 1] - merging->first[point];
    star->around_count = star->border_count = 0;
    if (star->tri_count == 0 || star->tri_count > MAX_STAR)
        return false;
    for (size_t t = 0; t < star->tri_count; t++)
        for (int i = 0; i < 3; i++) {
            uint32_t other = merging->mesh->tris[star->tris[t]][i];
            size_t at = place_in(star, other);
            if (other == point)
                continue;
            if (at == star->around_count) {
                star->around[star->around_count++] = other;
                star->faces[at] = 0;
            }
            star->faces[at]++;
        }
    for (size_t i = 0; i < star->around_count; i++) {
        star->border_count += star->faces[i] == 1;
        if (star->faces[i] > 2)
            return false;
    }
    return star->border_count ? star->border_count == 2 && star->tri_count + 1 == star->around_count
                              : star->tri_count == star->around_count;
}

/* Returns whether the edge to neighbour `at` is a short side of needles only, and whether merging its ends keeps the mesh a surface.
   The ends may share no neighbours except the third corners of these triangles. */
static bool is_needle_side(const struct merging *merging, const struct merge_star *star, size_t at)
{
    const uint32_t to = star->around[at], count = merging->first[to + 1] - merging->first[to];
    const double length_m = length_of(merging, star->point, to);
    uint32_t shared[2 * MAX_STAR];
    size_t shared_count = 0;
    if (length_m > merging->short_m || count > MAX_STAR)
        return false;
    for (size_t t = 0; t < star->tri_count; t++)
        if (trimesh_has(merging->mesh, star->tris[t], to) && longest_of(merging, star->tris[t]) < NEEDLE * length_m)
            return false;
    for (uint32_t t = merging->first[to]; t < merging->first[to + 1]; t++)
        for (int i = 0; i < 3; i++) {
            uint32_t other = merging->mesh->tris[merging->tris[t]][i];
            size_t known = 0;
            if (other == to || other == star->point || place_in(star, other) == star->around_count)
                continue;
            while (known < shared_count && shared[known] != other)
                known++;
            shared[known] = other;
            shared_count += known == shared_count;
        }
    return shared_count == star->faces[at];
}

/* Returns by how far the surface moves, in metres, if the star's point is merged with `to`. This is the larger of two distances:
   from `to` to the planes of the triangles that stay, and from the point to the new border. INFINITY: a triangle would turn over. */
static double displaced(const struct merging *merging, const struct merge_star *star, uint32_t to)
{
    const double *from = point_of(merging, star->point), *ends[2] = { from, from };
    double most_m = 0;
    for (size_t t = 0; t < star->tri_count; t++) {
        const uint32_t *v = merging->mesh->tris[star->tris[t]];
        const double *before[3], *after[3];
        double old[3], new[3], way[3];
        if (trimesh_has(merging->mesh, star->tris[t], to))
            continue;
        for (int i = 0; i < 3; i++) {
            before[i] = point_of(merging, v[i]);
            after[i] = v[i] == star->point ? point_of(merging, to) : before[i];
        }
        vec_normal(before[0], before[1], before[2], old);
        vec_normal(after[0], after[1], after[2], new);
        vec_sub(point_of(merging, to), from, way);
        if (!(vec_dot(old, new) > 0))
            return INFINITY;
        most_m = max_of(most_m, fabs(vec_dot(way, old)) / vec_length(old));
    }
    if (star->border_count == 0)
        return most_m;
    for (size_t i = 0, end = 0; i < star->around_count; i++)
        if (star->faces[i] == 1)
            ends[end++] = point_of(merging, star->around[i]);
    return max_of(most_m, vec_segment_distance(from, ends[0], ends[1]));
}

/* Merges the star's point with a neighbour. Locks all points of the star for this round. */
static void merge(const struct merging *merging, const struct merge_star *star, uint32_t to, double moved_m)
{
    merging->target[star->point] = to;
    for (size_t i = 0; i < star->around_count; i++) {
        float *beside_m = &merging->moved_m[star->around[i]];
        *beside_m = (float)max_of((double)*beside_m, moved_m);
        merging->locked[star->around[i]] = 1;
    }
    for (size_t t = 1; t < star->tri_count; t++)
        trimesh_join(merging->plane, merging->mesh->tri_source[star->tris[0]], merging->mesh->tri_source[star->tris[t]]);
}

/* Merges the point with its nearest neighbour that passes all checks. Returns false if none does. */
static bool try_point(const struct merging *merging, uint32_t point)
{
    struct merge_star star;
    double best_m = INFINITY, best_moved_m = 0;
    uint32_t best = TRIMESH_NONE;
    if (!collect_star(merging, point, &star))
        return false;
    for (size_t i = 0; i < star.around_count; i++) {
        const uint32_t to = star.around[i];
        const double length_m = length_of(merging, point, to);
        if (length_m >= best_m || (star.border_count && star.faces[i] != 1) || !is_needle_side(merging, &star, i))
            continue;
        const double step_m = displaced(merging, &star, to), moved_m = (double)merging->moved_m[point] + step_m;
        if (step_m > MAX_DISPLACED * length_m || moved_m > merging->within_m)
            continue;
        best_m = length_m;
        best_moved_m = moved_m;
        best = to;
    }
    if (best == TRIMESH_NONE)
        return false;
    merge(merging, &star, best, best_moved_m);
    return true;
}

/* Replaces each point by its target, and drops triangles that lost a corner. */
static void rename_points(const struct merging *merging)
{
    struct trimesh *mesh = merging->mesh;
    size_t kept = 0;
    for (size_t t = 0; t < mesh->tri_count; t++) {
        uint32_t v[3];
        for (int i = 0; i < 3; i++)
            v[i] = merging->target[mesh->tris[t][i]];
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0])
            continue;
        memcpy(mesh->tris[kept], v, sizeof(v));
        mesh->tri_source[kept] = mesh->tri_source[t];
        if (mesh->tri_times)
            mesh->tri_times[kept] = mesh->tri_times[t];
        kept++;
    }
    mesh->tri_count = kept;
}

static size_t merge_round(const struct merging *merging)
{
    size_t count = 0, points = merging->mesh->point_count;
    list_tris(merging);
    memset(merging->locked, 0, points);
    for (uint32_t p = 0; p < points; p++)
        merging->target[p] = p;
    for (uint32_t p = 0; p < points; p++)
        count += merging->is_short[p] && !merging->locked[p] && try_point(merging, p);
    if (count > 0)
        rename_points(merging);
    return count;
}

size_t short_sides_merge(struct trimesh *mesh, double size_m, double tolerance_m, uint32_t *plane)
{
    const double within_m = min_of(SHORT_SIDES_WITHIN * size_m, SHORT_SIDES_OF_TOLERANCE * tolerance_m);
    struct merging merging = { .mesh = mesh, .short_m = SHORT_OF_SIZE * size_m, .within_m = within_m, .plane = plane };
    size_t count = 0, more = 1, dropped = 0;
    merging.is_short = mem_try_array(mesh->point_count, 1);
    if (merging.is_short && mark_short(&merging)) {
        merging.locked = mem_try_array(mesh->point_count, 1);
        merging.moved_m = mem_try_array(mesh->point_count, sizeof(*merging.moved_m));
        merging.target = mem_try_array(mesh->point_count, sizeof(*merging.target));
        merging.first = mem_try_array(mesh->point_count + 2, sizeof(*merging.first));
        merging.tris = mem_try_array(3 * mesh->tri_count, sizeof(*merging.tris));
    }
    const bool good = merging.locked && merging.moved_m && merging.target && merging.first && merging.tris;
    for (int round = 0; good && round < MAX_ROUNDS && more > 0 && (round == 0 || mark_short(&merging)); round++)
        count += more = merge_round(&merging);
    if (count > 0)
        trimesh_clean(mesh, &dropped, &dropped);
    mem_free(merging.is_short);
    mem_free(merging.locked);
    mem_free(merging.moved_m);
    mem_free(merging.target);
    mem_free(merging.first);
    mem_free(merging.tris);
    return count;
}
