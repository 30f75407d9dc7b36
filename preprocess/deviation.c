/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Largest distance between two surfaces, by probing one against the other. */
#include "preprocess/deviation.h"

#include <pthread.h>
#include <stdatomic.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include "base/mem.h"
#include "surface/vec.h"

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

static void know_triangles(struct deviation *surface, const uint32_t *triangles, size_t triangle_count)
{
    surface->known_mask = 15;
    while (surface->known_mask < 2 * triangle_count)
        surface->known_mask = surface->known_mask * 2 + 1;
    surface->known = mem_array(surface->known_mask + 1, sizeof(*surface->known));
    for (size_t t = 0; t < triangle_count; t++) {
        uint64_t hash = triangle_hash(triangles + 3 * t);
        surface->known[slot_of(surface, hash)] = hash;
    }
}

void deviation_init(struct deviation *surface, const float (*positions_m)[3], const uint32_t *triangles, size_t triangle_count)
{
    *surface = (struct deviation){ 0 };
    for (size_t i = 0; i < 3 * triangle_count; i++)
        surface->highest = triangles[i] > surface->highest ? triangles[i] : surface->highest;
    surface->has = mem_array(surface->highest + 1, 1);
    uint32_t *point_of = mem_array(surface->highest + 1, sizeof(*point_of));
    size_t capacity = 0;
    for (size_t t = 0; t < triangle_count; t++) {
        uint32_t corners[3];
        for (int c = 0; c < 3; c++) {
            uint32_t v = triangles[3 * t + (size_t)c];
            const double p[3] = { (double)positions_m[v][0], (double)positions_m[v][1], (double)positions_m[v][2] };
            if (!surface->has[v]) {
                surface->has[v] = 1;
                point_of[v] = trimesh_add_point(&surface->mesh, p);
                mem_grow(&surface->index, &capacity, surface->mesh.point_count, sizeof(*surface->index));
                surface->index[point_of[v]] = v;
            }
            corners[c] = point_of[v];
        }
        trimesh_add_tri(&surface->mesh, corners[0], corners[1], corners[2], (uint32_t)t);
    }
    mem_free(point_of);
    know_triangles(surface, triangles, triangle_count);
    surface->bvh = bvh_create(&surface->mesh);
}

void deviation_finish(struct deviation *surface)
{
    bvh_destroy(&surface->bvh);
    trimesh_finish(&surface->mesh);
    mem_free(surface->index);
    mem_free(surface->has);
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
    double expected_m, limit_m;
    atomic_bool beyond; /* the limit */
    pthread_mutex_t lock;
    /* --- below: under lock */
    double most_m;
};

/* Looks near by first: most points are where they should be. */
static double distance_to(const struct bvh *to, const double point[3], double expected_m)
{
    struct bvh_place place;
    bvh_nearest(to, point, 2 * expected_m, NULL, NULL, &place);
    if (place.tri == TRIMESH_NONE)
        bvh_nearest(to, point, INFINITY, NULL, NULL, &place);
    return place.distance_m;
}

static void note(struct probing *probing, double most_m)
{
    pthread_mutex_lock(&probing->lock);
    probing->most_m = max_of(probing->most_m, most_m);
    pthread_mutex_unlock(&probing->lock);
    if (most_m > probing->limit_m)
        probing->beyond = true;
}

static void probe_points(void *arg, size_t begin, size_t end)
{
    struct probing *probing = arg;
    double most_m = 0;
    for (size_t i = begin; i < end && most_m <= probing->limit_m && !probing->beyond; i++)
        if (!shares_point(probing->to, probing->from->index[i]))
            most_m = max_of(most_m, distance_to(probing->to->bvh, probing->from->mesh.points[i], probing->expected_m));
    note(probing, most_m);
}

static double longest_edge(const struct trimesh *mesh, const uint32_t v[3])
{
    return max_of(vec_distance(mesh->points[v[0]], mesh->points[v[1]]),
                  max_of(vec_distance(mesh->points[v[1]], mesh->points[v[2]]), vec_distance(mesh->points[v[2]], mesh->points[v[0]])));
}

static double probe(const struct probing *probing, const uint32_t v[3], const double w[3])
{
    const double(*points)[3] = (const double(*)[3])probing->from->mesh.points;
    double point[3];
    for (int axis = 0; axis < 3; axis++)
        point[axis] = w[0] * points[v[0]][axis] + w[1] * points[v[1]][axis] + w[2] * points[v[2]][axis];
    return distance_to(probing->to->bvh, point, probing->expected_m);
}

static double probe_inside(const struct probing *probing, const uint32_t v[3], int cuts)
{
    double most_m = 0;
    for (int i = 0; i <= cuts; i++)
        for (int j = 0; i + j <= cuts; j++) {
            const double w[3] = { (double)i / cuts, (double)j / cuts, (double)(cuts - i - j) / cuts };
            if (i != cuts && j != cuts && i + j != 0)
                most_m = max_of(most_m, probe(probing, v, w));
        }
    return most_m;
}

/* Corners were probed; a triangle no larger than what is expected cannot stray much farther. */
static void probe_insides(void *arg, size_t begin, size_t end)
{
    struct probing *probing = arg;
    double most_m = 0;
    for (size_t t = begin; t < end && most_m <= probing->limit_m && !probing->beyond; t++) {
        const uint32_t *v = probing->from->mesh.tris[t];
        const uint32_t *index = probing->from->index, indices[3] = { index[v[0]], index[v[1]], index[v[2]] };
        double longest_m = longest_edge(&probing->from->mesh, v);
        if (longest_m <= probing->expected_m || shares_triangle(probing->to, indices))
            continue;
        if (longest_m < SMALL * probing->expected_m)
            most_m = max_of(most_m, probe(probing, v, (const double[3]){ 1 / 3.0, 1 / 3.0, 1 / 3.0 }));
        else
            most_m = max_of(most_m, probe_inside(probing, v, longest_m > LARGE * probing->expected_m ? 4 : 2));
    }
    note(probing, most_m);
}

static void for_all(struct workers *workers, size_t count, void (*body)(void *arg, size_t begin, size_t end), struct probing *probing)
{
    if (workers)
        workers_for(workers, count, 1024, body, probing);
    else
        body(probing, 0, count);
}

double deviation_measure(const struct deviation *from, const struct deviation *to, double expected_m, double limit_m,
                         struct workers *workers)
{
    struct probing probing = { .from = from, .to = to, .expected_m = expected_m, .limit_m = limit_m };
    pthread_mutex_init(&probing.lock, NULL);
    for_all(workers, from->mesh.point_count, probe_points, &probing);
    for_all(workers, from->mesh.tri_count, probe_insides, &probing);
    pthread_mutex_destroy(&probing.lock);
    return probing.most_m;
}
