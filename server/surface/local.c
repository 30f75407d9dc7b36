/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Unfolding distances outwards from a source, nearest point first. */
#include "surface/local.h"

#include <string.h>

#include "base/mem.h"
#include "surface/vec.h"

void local_init(struct local *local, const struct trimesh *mesh, size_t visible_count)
{
    local->mesh = mesh;
    local->visible_count = visible_count;
    local->hidden = mem_array(mesh->point_count, 1);
    memset(local->hidden, 1, mesh->point_count);
    for (size_t t = 0; t < visible_count; t++)
        for (int i = 0; i < 3; i++)
            local->hidden[mesh->tris[t][i]] = 0;
    local->first = mem_array(mesh->point_count + 2, sizeof(*local->first));
    local->tris = mem_array(mesh->tri_count * 3, sizeof(*local->tris));
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++)
            local->first[mesh->tris[t][i] + 2]++;
    for (size_t i = 2; i < mesh->point_count + 2; i++)
        local->first[i] += local->first[i - 1];
    for (uint32_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++)
            local->tris[local->first[mesh->tris[t][i] + 1]++] = t;
}

void local_finish(struct local *local)
{
    mem_free(local->first);
    mem_free(local->tris);
    mem_free(local->hidden);
    *local = (struct local){ 0 };
}

void local_walk_finish(struct local_walk *walk)
{
    mem_free(walk->distance_m);
    mem_free(walk->heap);
    mem_free(walk->reached);
    mem_free(walk->settled);
    *walk = (struct local_walk){ 0 };
}

static void heap_push(struct local_walk *walk, double distance_m, uint32_t point)
{
    mem_grow(&walk->heap, &walk->heap_capacity, walk->heap_count + 1, sizeof(*walk->heap));
    size_t i = walk->heap_count++;
    while (i > 0 && walk->heap[(i - 1) / 2].distance_m > distance_m) {
        walk->heap[i] = walk->heap[(i - 1) / 2];
        i = (i - 1) / 2;
    }
    walk->heap[i] = (struct local_item){ distance_m, point };
}

static struct local_item heap_pop(struct local_walk *walk)
{
    struct local_item top = walk->heap[0], last = walk->heap[--walk->heap_count];
    size_t i = 0;
    for (;;) {
        size_t child = 2 * i + 1;
        if (child >= walk->heap_count)
            break;
        if (child + 1 < walk->heap_count && walk->heap[child + 1].distance_m < walk->heap[child].distance_m)
            child++;
        if (walk->heap[child].distance_m >= last.distance_m)
            break;
        walk->heap[i] = walk->heap[child];
        i = child;
    }
    if (walk->heap_count)
        walk->heap[i] = last;
    return top;
}

static void offer(struct local_walk *walk, uint32_t point, double distance_m)
{
    if (!(distance_m < walk->distance_m[point] * (1 - 1e-12)))
        return;
    if (walk->distance_m[point] == INFINITY) {
        mem_grow(&walk->reached, &walk->reached_capacity, walk->reached_count + 1, sizeof(*walk->reached));
        walk->reached[walk->reached_count++] = point;
    }
    walk->distance_m[point] = distance_m;
    heap_push(walk, distance_m, point);
}

double local_unfold(double da, double db, double ab, double ac, double bc)
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

static void spread(const struct local *local, struct local_walk *walk, uint32_t point)
{
    const struct trimesh *mesh = local->mesh;
    for (uint32_t i = local->first[point]; i < local->first[point + 1]; i++) {
        const uint32_t *v = mesh->tris[local->tris[i]];
        int at = v[0] == point ? 0 : v[1] == point ? 1 : 2;
        uint32_t a = v[(at + 1) % 3], b = v[(at + 2) % 3];
        double pa = vec_distance(mesh->points[point], mesh->points[a]), pb = vec_distance(mesh->points[point], mesh->points[b]);
        double ab = vec_distance(mesh->points[a], mesh->points[b]), d = walk->distance_m[point];
        bool inside = local->tris[i] >= local->visible_count;
        if (!inside || local->hidden[a])
            offer(walk, a, walk->settled[b] ? local_unfold(d, walk->distance_m[b], pb, pa, ab) : d + pa);
        if (!inside || local->hidden[b])
            offer(walk, b, walk->settled[a] ? local_unfold(d, walk->distance_m[a], pa, pb, ab) : d + pb);
    }
}

static void clear(const struct local *local, struct local_walk *walk)
{
    if (!walk->distance_m) {
        walk->distance_m = mem_array(local->mesh->point_count, sizeof(*walk->distance_m));
        walk->settled = mem_array(local->mesh->point_count, 1);
        for (size_t i = 0; i < local->mesh->point_count; i++)
            walk->distance_m[i] = INFINITY;
    }
    for (size_t i = 0; i < walk->reached_count; i++) {
        walk->distance_m[walk->reached[i]] = INFINITY;
        walk->settled[walk->reached[i]] = 0;
    }
    walk->reached_count = walk->heap_count = 0;
}

void local_from(const struct local *local, struct local_walk *walk, uint32_t tri, const double weights[3], double limit_m)
{
    const struct trimesh *mesh = local->mesh;
    const uint32_t *v = mesh->tris[tri];
    double source[3];
    clear(local, walk);
    for (int axis = 0; axis < 3; axis++)
        source[axis] =
            weights[0] * mesh->points[v[0]][axis] + weights[1] * mesh->points[v[1]][axis] + weights[2] * mesh->points[v[2]][axis];
    for (int i = 0; i < 3; i++)
        offer(walk, v[i], vec_distance(source, mesh->points[v[i]]));
    while (walk->heap_count) {
        struct local_item item = heap_pop(walk);
        if (item.distance_m > walk->distance_m[item.point] || walk->settled[item.point])
            continue;
        if (item.distance_m > limit_m)
            break;
        walk->settled[item.point] = 1;
        spread(local, walk, item.point);
    }
}
