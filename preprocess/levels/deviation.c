/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the largest distance between two surfaces by measuring the distances of points on one surface ("probes") from the other. */
#include "preprocess/levels/deviation.h"

#include <math.h>
#include <string.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include "base/math/vec.h"
#include "base/mem.h"

/* Longest edge of a triangle, in multiples of the expected distance, up to which the triangle is probed (measured) only at its
   centre. */
#define SMALL 4.0
/* Longest edge of a triangle, in multiples of the expected distance, above which the triangle is probed at twelve inner points.
   Triangles between SMALL and LARGE are probed at the midpoints of their edges. */
#define LARGE 16.0

#define GRAIN 1024 /* number of points that a thread measures per unit of work */

/* Returns a hash of three vertex indices that does not depend on their order and is never 0. */
static uint64_t triangle_hash(const uint32_t v[3])
{
    uint32_t low = v[0], middle = v[1], high = v[2], swap;
    if (low > middle)
        swap = low, low = middle, middle = swap;
    if (middle > high)
        swap = middle, middle = high, high = swap;
    if (low > middle)
        swap = low, low = middle, middle = swap;
    const uint32_t sorted[3] = { low, middle, high };
    return XXH3_64bits(sorted, sizeof(sorted)) | 1;
}

static size_t slot_of(const struct deviation *surface, uint64_t hash)
{
    size_t slot = (hash >> 1) & surface->known_mask;
    while (surface->known[slot] && surface->known[slot] != hash)
        slot = (slot + 1) & surface->known_mask;
    return slot;
}

static void make_room_to_know(struct deviation *surface, size_t triangle_count)
{
    surface->known_mask = 15;
    while (surface->known_mask < 2 * triangle_count)
        surface->known_mask = surface->known_mask * 2 + 1;
    surface->known = mem_array(surface->known_mask + 1, sizeof(*surface->known));
}

/* Adds a triangle to the surface's hash set of triangles. Returns false if the set already has one with the same corners. */
static bool know_triangle(struct deviation *surface, const uint32_t v[3])
{
    uint64_t hash = triangle_hash(v), *slot = &surface->known[slot_of(surface, hash)];
    bool is_new = *slot == 0;
    *slot = hash;
    return is_new;
}

struct deviation_part {
    /* triangles of one part (connected component), in the whole surface's arrays; tri_count 0: this surface has no triangle of the part */
    struct trimesh mesh;
    struct bvh *bvh; /* bounding volume hierarchy of the part's triangles; NULL: the part is not measured */
};

/* Returns the triangle indices grouped by part (connected component). The caller frees them with mem_free. */
static size_t *sort_by_part(const struct deviation_params *params, const uint32_t *triangles, size_t count)
{
    size_t *first = mem_array(params->part_count + 1, sizeof(*first)), *order = mem_array(count, sizeof(*order));
    for (size_t t = 0; t < count; t++)
        first[params->part[triangles[3 * t]] + 1]++;
    for (size_t p = 0; p < params->part_count; p++)
        first[p + 1] += first[p];
    for (size_t t = 0; t < count; t++)
        order[first[params->part[triangles[3 * t]]]++] = t;
    mem_free(first);
    return order;
}

/* Records for each part (connected component) the range of its triangles in the mesh, which is sorted by part. */
static void list_parts(struct deviation *surface)
{
    const struct trimesh *mesh = &surface->mesh;
    for (size_t t = 0; t < mesh->tri_count; t++) {
        struct trimesh *of = &surface->parts[surface->part[surface->index[mesh->tris[t][0]]]].mesh;
        if (of->tri_count++ == 0) {
            of->points = mesh->points;
            of->point_count = mesh->point_count;
            of->tris = mesh->tris + t;
        }
    }
}

static void index_parts(struct deviation *surface, const char *only)
{
    for (size_t p = 0; p < surface->part_count; p++)
        if (surface->parts[p].mesh.tri_count && (!only || only[p]))
            surface->parts[p].bvh = bvh_create(&surface->parts[p].mesh);
}

void deviation_init(struct deviation *surface, const struct deviation_params *params, const uint32_t *triangles, size_t triangle_count)
{
    *surface = (struct deviation){ .part = params->part,
                                   .part_count = params->part_count,
                                   .parts = mem_array(params->part_count, sizeof(*surface->parts)) };
    for (size_t i = 0; i < 3 * triangle_count; i++)
        surface->highest = triangles[i] > surface->highest ? triangles[i] : surface->highest;
    surface->has = mem_array(surface->highest + 1, 1);
    uint32_t *point_of = mem_array(surface->highest + 1, sizeof(*point_of));
    size_t capacity = 0, *order = sort_by_part(params, triangles, triangle_count);
    make_room_to_know(surface, triangle_count);
    for (size_t i = 0; i < triangle_count; i++) {
        size_t t = order[i];
        uint32_t corners[3], v[3];
        for (size_t c = 0; c < 3; c++)
            v[c] = params->first_there[triangles[3 * t + c]];
        if (!know_triangle(surface, v))
            continue;
        for (int c = 0; c < 3; c++) {
            const float *at = params->positions_m[v[c]];
            const double p[3] = { (double)at[0], (double)at[1], (double)at[2] };
            if (!surface->has[v[c]]) {
                surface->has[v[c]] = 1;
                point_of[v[c]] = trimesh_add_point(&surface->mesh, p);
                mem_grow(&surface->index, &capacity, surface->mesh.point_count, sizeof(*surface->index));
                surface->index[point_of[v[c]]] = v[c];
            }
            corners[c] = point_of[v[c]];
        }
        trimesh_add_tri(&surface->mesh, corners[0], corners[1], corners[2], (uint32_t)t);
    }
    mem_free(point_of);
    mem_free(order);
    list_parts(surface);
    if (params->anywhere)
        surface->whole = bvh_create(&surface->mesh);
    else
        index_parts(surface, params->only);
}

void deviation_finish(struct deviation *surface)
{
    for (size_t p = 0; p < surface->part_count; p++)
        bvh_destroy(&surface->parts[p].bvh);
    bvh_destroy(&surface->whole);
    trimesh_finish(&surface->mesh);
    mem_free(surface->parts);
    mem_free(surface->index);
    mem_free(surface->has);
    mem_free(surface->known);
    *surface = (struct deviation){ 0 };
}

const struct bvh *deviation_hierarchy(const struct deviation *surface, size_t part)
{
    return surface->parts[part].bvh;
}

static bool shares_point(const struct deviation *surface, uint32_t index)
{
    return index <= surface->highest && surface->has[index];
}

static bool shares_triangle(const struct deviation *surface, const uint32_t indices[3])
{
    return surface->known[slot_of(surface, triangle_hash(indices))] != 0;
}

struct probing {
    const struct deviation *from, *to;
    /* by part (connected component): nonzero: measure the distances of its points; NULL: measure all parts */
    const char *only;
    bool anywhere; /* true: measure the distance from any part of `to`; false: from the same part (connected component) */
    double expected_m;
    const float *known_m; /* by part (connected component): largest distance found before this pass; smaller distances need not be exact */
    float *found_m;       /* by vertex, or by triangle in the second pass: its measured distance */
};

#define RECENT 4
struct near { /* cache of one thread: the triangles that were nearest to recent points */
    /* indices of the triangles of part `part` of surface `to` that were nearest to recent points, latest first; TRIMESH_NONE: empty
     * entry */
    uint32_t part, tris[RECENT];
    double known_m; /* largest distance of the part (connected component) found so far by this thread, metres */
};

struct deviation_probe {   /* state of one distance measurement ("probe"): a point, and the surface from which its distance is measured */
    const struct bvh *bvh; /* bounding volume hierarchy to search; NULL: `to` has no triangle of the part */
    const struct trimesh *mesh;
    double point[3];
    struct near *near;
};

static uint32_t part_of(const struct deviation *surface, uint32_t tri)
{
    return surface->part[surface->index[surface->mesh.tris[tri][0]]];
}

static bool is_within(const double p[3], const struct trimesh *mesh, uint32_t tri, double limit_m)
{
    const uint32_t *v = mesh->tris[tri];
    const double *a = mesh->points[v[0]], *b = mesh->points[v[1]], *c = mesh->points[v[2]];
    double w[3], at[3];
    if (triangle_is_farther(p, a, b, c, limit_m))
        return false;
    triangle_nearest(p, a, b, c, w);
    for (int axis = 0; axis < 3; axis++)
        at[axis] = w[0] * a[axis] + w[1] * b[axis] + w[2] * c[axis];
    return vec_distance(p, at) <= limit_m;
}

static void keep_first(struct near *near, int place, uint32_t tri)
{
    for (; place > 0; place--)
        near->tris[place] = near->tris[place - 1];
    near->tris[0] = tri;
}

/* Returns whether one of the recently nearest triangles (near->tris) is closer to the probed point than the largest known
 * distance, which makes a search unnecessary. Neighbouring points often have the same nearest triangle. */
static bool is_known(const struct deviation_probe *probe)
{
    struct near *near = probe->near;
    uint32_t found = TRIMESH_NONE;
    if (isinf(near->known_m) || near->known_m <= 0)
        return isinf(near->known_m);
    for (int i = 0; i < RECENT && near->tris[i] != TRIMESH_NONE; i++)
        if (is_within(probe->point, probe->mesh, near->tris[i], near->known_m)) {
            keep_first(near, i, near->tris[i]);
            return true;
        }
    if (!bvh_any_within(probe->bvh, probe->point, near->known_m, NULL, NULL, &found))
        return false;
    keep_first(near, RECENT - 1, found);
    return true;
}

static void forget(struct near *near)
{
    for (int i = 0; i < RECENT; i++)
        near->tris[i] = TRIMESH_NONE;
}

/* Returns the distance of the probed point from the other surface, or 0 if it is not larger than the largest distance found so
 * far. First searches within the expected distance, which is enough for most points. */
static double distance_of(const struct deviation_probe *probe, double expected_m)
{
    struct bvh_place place;
    if (!probe->bvh)
        return INFINITY;
    if (is_known(probe))
        return 0;
    bvh_nearest(probe->bvh, probe->point, 2 * expected_m, NULL, NULL, &place);
    if (place.tri == TRIMESH_NONE)
        bvh_nearest(probe->bvh, probe->point, INFINITY, NULL, NULL, &place);
    probe->near->known_m = max_of(probe->near->known_m, (double)(float)place.distance_m);
    return place.distance_m;
}

static struct deviation_probe probe_of(const struct probing *probing, uint32_t part, struct near *near)
{
    const struct deviation *to = probing->to;
    if (near->part != part) {
        near->part = part;
        near->known_m = (double)probing->known_m[part];
        if (!probing->anywhere)
            forget(near);
    }
    return (struct deviation_probe){ .bvh = probing->anywhere ? to->whole : to->parts[part].bvh,
                                     .mesh = probing->anywhere ? &to->mesh : &to->parts[part].mesh,
                                     .near = near };
}

static void probe_point(const struct probing *probing, size_t i, struct near *near)
{
    const struct deviation *from = probing->from;
    uint32_t part = from->part[from->index[i]];
    if ((probing->only && !probing->only[part]) || shares_point(probing->to, from->index[i]))
        return;
    struct deviation_probe probe = probe_of(probing, part, near);
    memcpy(probe.point, from->mesh.points[i], sizeof(probe.point));
    probing->found_m[i] = (float)distance_of(&probe, probing->expected_m);
}

static double longest_edge(const struct trimesh *mesh, const uint32_t v[3])
{
    const double *a = mesh->points[v[0]], *b = mesh->points[v[1]], *c = mesh->points[v[2]];
    return sqrt(max_of(vec_distance2(a, b), max_of(vec_distance2(b, c), vec_distance2(c, a))));
}

static double probe_at(const struct probing *probing, size_t t, const double w[3], struct near *near)
{
    const struct trimesh *mesh = &probing->from->mesh;
    const uint32_t *v = mesh->tris[t];
    struct deviation_probe probe = probe_of(probing, part_of(probing->from, (uint32_t)t), near);
    for (int axis = 0; axis < 3; axis++)
        probe.point[axis] = w[0] * mesh->points[v[0]][axis] + w[1] * mesh->points[v[1]][axis] + w[2] * mesh->points[v[2]][axis];
    return distance_of(&probe, probing->expected_m);
}

/* Returns whether one of the recently nearest triangles (near->tris) has all of triangle t within the largest known distance,
 * so that t need not be measured. The distance from a triangle is a convex function, so its maximum over t is at a corner of t.
 * */
static bool is_covered(const struct probing *probing, size_t t, struct near *near)
{
    const struct trimesh *mesh = &probing->from->mesh;
    const uint32_t *v = mesh->tris[t];
    struct deviation_probe probe = probe_of(probing, part_of(probing->from, (uint32_t)t), near);
    for (int axis = 0; axis < 3; axis++)
        probe.point[axis] = (mesh->points[v[0]][axis] + mesh->points[v[1]][axis] + mesh->points[v[2]][axis]) / 3;
    if (!probe.bvh || isinf(near->known_m) || !is_known(&probe))
        return false;
    for (int i = 0; i < 3; i++)
        if (!is_within(mesh->points[v[i]], probe.mesh, near->tris[0], near->known_m))
            return false;
    return true;
}

static double probe_inside(const struct probing *probing, size_t t, int cuts, struct near *near)
{
    double most_m = 0;
    if (is_covered(probing, t, near))
        return 0;
    for (int i = 0; i <= cuts; i++)
        for (int j = 0; i + j <= cuts; j++) {
            const double w[3] = { (double)i / cuts, (double)j / cuts, (double)(cuts - i - j) / cuts };
            if (i != cuts && j != cuts && i + j != 0)
                most_m = max_of(most_m, probe_at(probing, t, w, near));
        }
    return most_m;
}

/* Measures the distance of points inside a triangle from the other surface; its corners are measured separately. Skips a
 * triangle whose longest edge is at most the expected distance, because its inner points cannot be much farther away than its
 * corners. Also skips a triangle that is part of both surfaces. */
static void probe_triangle(const struct probing *probing, size_t t, struct near *near)
{
    const struct deviation *from = probing->from;
    const uint32_t *v = from->mesh.tris[t], indices[3] = { from->index[v[0]], from->index[v[1]], from->index[v[2]] };
    if (probing->only && !probing->only[part_of(from, (uint32_t)t)])
        return;
    double longest_m = longest_edge(&from->mesh, v), most_m;
    if (longest_m <= probing->expected_m || shares_triangle(probing->to, indices))
        return;
    if (longest_m < SMALL * probing->expected_m)
        most_m = probe_at(probing, t, (const double[3]){ 1 / 3.0, 1 / 3.0, 1 / 3.0 }, near);
    else
        most_m = probe_inside(probing, t, longest_m > LARGE * probing->expected_m ? 4 : 2, near);
    probing->found_m[t] = (float)most_m;
}

static void probe_points(void *arg, size_t begin, size_t end)
{
    struct near near = { .part = UINT32_MAX };
    forget(&near);
    for (size_t i = begin; i < end; i++)
        probe_point(arg, i, &near);
}

static void probe_triangles(void *arg, size_t begin, size_t end)
{
    struct near near = { .part = UINT32_MAX };
    forget(&near);
    for (size_t t = begin; t < end; t++)
        probe_triangle(arg, t, &near);
}

static void raise_to(float *most_m, float found_m)
{
    *most_m = *most_m < found_m ? found_m : *most_m;
}

/* Measures the distances of surface `from` to surface `to`. Measures the corners of all triangles first, because they can show
 * that a triangle's inside cannot raise the result. */
static void measure(const struct deviation *from, const struct deviation *to, const char *only, bool anywhere, double expected_m,
                    float *apart_m, struct workers *workers)
{
    size_t points = from->mesh.point_count, triangles = from->mesh.tri_count;
    float *found_m = mem_array(points > triangles ? points : triangles, sizeof(*found_m));
    struct probing probing = { from, to, only, anywhere, expected_m, apart_m, found_m };
    workers_for(workers, points, GRAIN, probe_points, &probing);
    for (size_t i = 0; i < points; i++)
        raise_to(&apart_m[from->part[from->index[i]]], probing.found_m[i]);
    memset(probing.found_m, 0, triangles * sizeof(*probing.found_m));
    workers_for(workers, triangles, GRAIN, probe_triangles, &probing);
    for (size_t t = 0; t < triangles; t++)
        raise_to(&apart_m[part_of(from, (uint32_t)t)], probing.found_m[t]);
    mem_free(probing.found_m);
}

void deviation_measure(const struct deviation *from, const struct deviation *to, const char *only, double expected_m, float *apart_m,
                       struct workers *workers)
{
    measure(from, to, only, false, expected_m, apart_m, workers);
}

void deviation_measure_lost(const struct deviation *from, const struct deviation *to, const char *lost, double expected_m, float *apart_m,
                            struct workers *workers)
{
    measure(from, to, lost, true, expected_m, apart_m, workers);
}
