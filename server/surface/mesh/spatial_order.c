/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sorts points along a Morton curve and triangles by their first point. */
#include "surface/mesh/spatial_order.h"

#include <stdlib.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"

#define BITS 21 /* bits per coordinate, so that three coordinates fit into a 64-bit key */

struct keyed {
    uint64_t key;
    uint32_t item;
};

static int by_key(const void *a, const void *b)
{
    const struct keyed *p = a, *q = b;
    if (p->key != q->key)
        return p->key < q->key ? -1 : 1;
    return p->item < q->item ? -1 : p->item > q->item;
}

static uint64_t spread_bits(uint64_t x)
{
    x = (x | x << 32) & 0x1f00000000ffffull;
    x = (x | x << 16) & 0x1f0000ff0000ffull;
    x = (x | x << 8) & 0x100f00f00f00f00full;
    x = (x | x << 4) & 0x10c30c30c30c30c3ull;
    return (x | x << 2) & 0x1249249249249249ull;
}

static void order_points(struct trimesh *mesh, uint32_t *target)
{
    struct keyed *keyed = mem_array(mesh->point_count, sizeof(*keyed));
    double(*points)[3] = mem_array(mesh->point_count, sizeof(*points)), low[3], size = 0;
    for (int axis = 0; axis < 3; axis++) {
        double high = -INFINITY;
        low[axis] = INFINITY;
        for (size_t i = 0; i < mesh->point_count; i++) {
            low[axis] = min_of(low[axis], mesh->points[i][axis]);
            high = max_of(high, mesh->points[i][axis]);
        }
        size = max_of(size, high - low[axis]);
    }
    for (uint32_t i = 0; i < mesh->point_count; i++) {
        keyed[i].item = i;
        for (int axis = 0; axis < 3 && size > 0; axis++)
            keyed[i].key |= spread_bits((uint64_t)((mesh->points[i][axis] - low[axis]) / size * ((1 << BITS) - 1))) << axis;
    }
    qsort(keyed, mesh->point_count, sizeof(*keyed), by_key);
    for (uint32_t i = 0; i < mesh->point_count; i++) {
        target[keyed[i].item] = i;
        memcpy(points[i], mesh->points[keyed[i].item], sizeof(*points));
    }
    mem_free(mesh->points);
    mesh->points = points;
    mesh->point_capacity = mesh->point_count;
    mem_free(keyed);
}

static void order_tris(struct trimesh *mesh, size_t begin, size_t end)
{
    struct keyed *keyed = mem_array(end - begin, sizeof(*keyed));
    uint32_t(*tris)[3] = mem_array(end - begin, sizeof(*tris)), *source = mem_array(end - begin, sizeof(*source));
    for (size_t i = 0; i < end - begin; i++) {
        const uint32_t *v = mesh->tris[begin + i];
        uint32_t first = v[0] < v[1] ? v[0] : v[1];
        keyed[i] = (struct keyed){ first < v[2] ? first : v[2], (uint32_t)i };
        memcpy(tris[i], v, sizeof(*tris));
        source[i] = mesh->tri_source[begin + i];
    }
    qsort(keyed, end - begin, sizeof(*keyed), by_key);
    for (size_t i = 0; i < end - begin; i++) {
        memcpy(mesh->tris[begin + i], tris[keyed[i].item], sizeof(*tris));
        mesh->tri_source[begin + i] = source[keyed[i].item];
    }
    mem_free(keyed);
    mem_free(tris);
    mem_free(source);
}

void spatial_order_mesh(struct trimesh *mesh, size_t visible_count, uint32_t *target)
{
    order_points(mesh, target);
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++)
            mesh->tris[t][i] = target[mesh->tris[t][i]];
    order_tris(mesh, 0, visible_count);
    order_tris(mesh, visible_count, mesh->tri_count);
}
