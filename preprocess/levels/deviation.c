/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Largest distance between two surfaces, by probing one against the other. */
#include "preprocess/levels/deviation.h"

#include <math.h>
#include <string.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include "base/mem.h"
#include "base/vec.h"

#define SMALL 4.0  /* expected distances: in smaller triangles the middle is probed */
#define LARGE 16.0 /* likewise: in larger ones, twelve points inside; else the middles of the edges */

/* The same for every order of the corners. Never 0. */
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

/* False: one with the same corners is known already. */
static bool know_triangle(struct deviation *surface, const uint32_t v[3])
{
    uint64_t hash = triangle_hash(v), *slot = &surface->known[slot_of(surface, hash)];
    bool is_new = *slot == 0;
    *slot = hash;
    return is_new;
}

void deviation_init(struct deviation *surface, const float (*positions_m)[3], const uint32_t *first_there, const uint32_t *part,
                    size_t part_count, const uint32_t *triangles, size_t triangle_count)
{
    *surface = (struct deviation){ .part = part, .has_part = mem_array(part_count, 1) };
    for (size_t i = 0; i < 3 * triangle_count; i++)
        surface->highest = triangles[i] > surface->highest ? triangles[i] : surface->highest;
    surface->has = mem_array(surface->highest + 1, 1);
    uint32_t *point_of = mem_array(surface->highest + 1, sizeof(*point_of));
    size_t capacity = 0;
    make_room_to_know(surface, triangle_count);
    for (size_t t = 0; t < triangle_count; t++) {
        uint32_t corners[3], v[3];
        for (size_t c = 0; c < 3; c++)
            v[c] = first_there[triangles[3 * t + c]];
        if (!know_triangle(surface, v))
            continue;
        for (int c = 0; c < 3; c++) {
            const float *at = positions_m[v[c]];
            const double p[3] = { (double)at[0], (double)at[1], (double)at[2] };
            if (!surface->has[v[c]]) {
                surface->has[v[c]] = surface->has_part[part[v[c]]] = 1;
                point_of[v[c]] = trimesh_add_point(&surface->mesh, p);
                mem_grow(&surface->index, &capacity, surface->mesh.point_count, sizeof(*surface->index));
                surface->index[point_of[v[c]]] = v[c];
            }
            corners[c] = point_of[v[c]];
        }
        trimesh_add_tri(&surface->mesh, corners[0], corners[1], corners[2], (uint32_t)t);
    }
    mem_free(point_of);
    surface->bvh = bvh_create(&surface->mesh);
}

void deviation_finish(struct deviation *surface)
{
    bvh_destroy(&surface->bvh);
    trimesh_finish(&surface->mesh);
    mem_free(surface->index);
    mem_free(surface->has);
    mem_free(surface->has_part);
    mem_free(surface->known);
    *surface = (struct deviation){ 0 };
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
    const char *only; /* by part: it is probed; NULL: all are */
    bool anywhere;    /* against all of `to`, or each part against itself */
    double expected_m;
    const float *known_m; /* of each part, from before: what is no farther is of no interest */
    float *found_m;       /* of each point, then of each triangle */
};

struct probe { /* a point, and the part that it is of */
    const struct deviation *to;
    bool anywhere; /* against all of `to` */
    uint32_t part;
    double known_m;
    double point[3];
    uint32_t *near; /* the thread's: a triangle of `to` that was near to some point before, or TRIMESH_NONE */
};

static uint32_t part_of(const struct deviation *surface, uint32_t tri)
{
    return surface->part[surface->index[surface->mesh.tris[tri][0]]];
}

static bool is_of_part(const void *arg, uint32_t tri)
{
    const struct probe *probe = arg;
    return part_of(probe->to, tri) == probe->part;
}

/* 0: no more than is known. Looks near by first: most points are where they should be. */
static double distance_of(const struct probe *probe, double expected_m)
{
    struct bvh_place place;
    bool (*counts)(const void *, uint32_t) = probe->anywhere ? NULL : is_of_part;
    if (!probe->anywhere && !probe->to->has_part[probe->part])
        return INFINITY;
    if (isinf(probe->known_m) ||
        (probe->known_m > 0 && bvh_any_within(probe->to->bvh, probe->point, probe->known_m, counts, probe, probe->near)))
        return 0;
    bvh_nearest(probe->to->bvh, probe->point, 2 * expected_m, counts, probe, &place);
    if (place.tri == TRIMESH_NONE)
        bvh_nearest(probe->to->bvh, probe->point, INFINITY, counts, probe, &place);
    return place.distance_m;
}

static struct probe probe_of(const struct probing *probing, uint32_t part, uint32_t *near)
{
    return (struct probe){
        .to = probing->to, .anywhere = probing->anywhere, .part = part, .known_m = (double)probing->known_m[part], .near = near
    };
}

static void probe_point(const struct probing *probing, size_t i, uint32_t *near)
{
    const struct deviation *from = probing->from;
    struct probe probe = probe_of(probing, from->part[from->index[i]], near);
    if ((probing->only && !probing->only[probe.part]) || shares_point(probing->to, from->index[i]))
        return;
    memcpy(probe.point, from->mesh.points[i], sizeof(probe.point));
    probing->found_m[i] = (float)distance_of(&probe, probing->expected_m);
}

static double longest_edge(const struct trimesh *mesh, const uint32_t v[3])
{
    return max_of(vec_distance(mesh->points[v[0]], mesh->points[v[1]]),
                  max_of(vec_distance(mesh->points[v[1]], mesh->points[v[2]]), vec_distance(mesh->points[v[2]], mesh->points[v[0]])));
}

static double probe_at(const struct probing *probing, size_t t, const double w[3], uint32_t *near)
{
    const struct trimesh *mesh = &probing->from->mesh;
    const uint32_t *v = mesh->tris[t];
    struct probe probe = probe_of(probing, part_of(probing->from, (uint32_t)t), near);
    for (int axis = 0; axis < 3; axis++)
        probe.point[axis] = w[0] * mesh->points[v[0]][axis] + w[1] * mesh->points[v[1]][axis] + w[2] * mesh->points[v[2]][axis];
    return distance_of(&probe, probing->expected_m);
}

static double probe_inside(const struct probing *probing, size_t t, int cuts, uint32_t *near)
{
    double most_m = 0;
    for (int i = 0; i <= cuts; i++)
        for (int j = 0; i + j <= cuts; j++) {
            const double w[3] = { (double)i / cuts, (double)j / cuts, (double)(cuts - i - j) / cuts };
            if (i != cuts && j != cuts && i + j != 0)
                most_m = max_of(most_m, probe_at(probing, t, w, near));
        }
    return most_m;
}

/* Corners are probed; a triangle no larger than what is expected cannot stray much farther. */
static void probe_triangle(const struct probing *probing, size_t t, uint32_t *near)
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
    probing->found_m[from->mesh.point_count + t] = (float)most_m;
}

static void probe_some(void *arg, size_t begin, size_t end)
{
    const struct probing *probing = arg;
    uint32_t near = TRIMESH_NONE;
    for (size_t i = begin; i < end; i++)
        if (i < probing->from->mesh.point_count)
            probe_point(probing, i, &near);
        else
            probe_triangle(probing, i - probing->from->mesh.point_count, &near);
}

static void measure(const struct deviation *from, const struct deviation *to, const char *only, bool anywhere, double expected_m,
                    float *apart_m, struct workers *workers)
{
    size_t points = from->mesh.point_count, count = points + from->mesh.tri_count;
    struct probing probing = { from, to, only, anywhere, expected_m, apart_m, mem_array(count, sizeof(float)) };
    if (workers)
        workers_for(workers, count, 1024, probe_some, &probing);
    else
        probe_some(&probing, 0, count);
    for (size_t i = 0; i < count; i++) {
        float *at = &apart_m[i < points ? from->part[from->index[i]] : part_of(from, (uint32_t)(i - points))];
        *at = *at < probing.found_m[i] ? probing.found_m[i] : *at;
    }
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
