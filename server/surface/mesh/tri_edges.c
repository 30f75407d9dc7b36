/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Collects the edges of triangles in a hash table, finds the triangle on the other side of an edge, and orients triangles. */
#include "surface/mesh/tri_edges.h"

#include "base/mem.h"
#include "surface/mesh/trimesh.h"

static void list_edges(struct tri_edges *e)
{
    struct edge_table table;
    edge_table_init(&table, e->tri_count * 3 / 2);
    for (uint32_t side = 0; side < 3 * e->tri_count; side++) {
        const uint32_t *tri = e->tris[side / 3];
        if (side % 3 == 0)
            edge_table_prefetch_ahead(&table, e->tris, side / 3, e->tri_count);
        uint32_t number = edge_table_add(&table, tri[side % 3], tri[(side % 3 + 1) % 3]);
        struct tri_edge *edge = &e->edges[number];
        if (edge->faces < 2)
            edge->sides[edge->faces] = side;
        edge->faces++;
        e->of_side[side] = number;
    }
    edge_table_finish(&table);
}

void tri_edges_init(struct tri_edges *e, const uint32_t (*tris)[3], size_t tri_count)
{
    *e = (struct tri_edges){ .tris = tris, .tri_count = tri_count };
    e->edges = mem_array(3 * tri_count, sizeof(*e->edges));
    e->of_side = mem_array(3 * tri_count, sizeof(*e->of_side));
    list_edges(e);
}

bool tri_edges_try_init(struct tri_edges *e, const uint32_t (*tris)[3], size_t tri_count)
{
    *e = (struct tri_edges){ .tris = tris, .tri_count = tri_count };
    e->edges = mem_try_array(3 * tri_count, sizeof(*e->edges));
    e->of_side = mem_try_array(3 * tri_count, sizeof(*e->of_side));
    if (e->edges && e->of_side) {
        list_edges(e);
        return true;
    }
    tri_edges_finish(e);
    return false;
}

void tri_edges_finish(struct tri_edges *e)
{
    mem_free(e->edges);
    mem_free(e->of_side);
    *e = (struct tri_edges){ 0 };
}

uint32_t tri_edges_across(const struct tri_edges *e, uint32_t side)
{
    const struct tri_edge *edge = &e->edges[e->of_side[side]];
    uint32_t other = edge->sides[edge->sides[0] == side];
    return edge->faces == 2 && other / 3 != side / 3 ? other : TRIMESH_NONE;
}

bool tri_edges_run_alike(const struct tri_edges *e, uint32_t side, uint32_t other)
{
    return e->tris[side / 3][side % 3] == e->tris[other / 3][other % 3];
}

size_t tri_edges_orient(const struct tri_edges *e, uint32_t first, signed char *facing, uint32_t *joined, bool *two_sided)
{
    size_t count = 0;
    facing[first] = 1;
    joined[count++] = first;
    *two_sided = true;
    for (size_t done = 0; done < count; done++) {
        uint32_t t = joined[done];
        for (uint32_t side = 3 * t; side < 3 * t + 3; side++) {
            uint32_t other = tri_edges_across(e, side);
            if (other == TRIMESH_NONE)
                continue;
            signed char way = tri_edges_run_alike(e, side, other) ? (signed char)-facing[t] : facing[t];
            if (facing[other / 3] == 0) {
                facing[other / 3] = way;
                joined[count++] = other / 3;
            }
            *two_sided &= facing[other / 3] == way;
        }
    }
    return count;
}

void tri_edges_orient_all(const struct tri_edges *e, signed char *facing)
{
    uint32_t *joined = mem_array(e->tri_count, sizeof(*joined));
    bool two_sided;
    for (uint32_t t = 0; t < e->tri_count; t++)
        if (!facing[t])
            tri_edges_orient(e, t, facing, joined, &two_sided);
    mem_free(joined);
}
