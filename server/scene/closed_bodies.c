/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds closed bodies: welds vertices by position, groups connected triangles, and counts the uses of each edge in both directions. */
#include "scene/closed_bodies.h"

#include <math.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include "base/mem.h"

enum { MAX_INDICES = 3 * 1000 * 1000 };
static const float WELD_PART = 1e-5f; /* distance within which vertices are welded (treated as one), relative to the asset's size */

struct edge_count {
    /* key of an edge: index of its lower-numbered vertex << 32 | index of the other; 0: free slot of the hash table, because no edge joins
       a vertex to itself */
    uint64_t ends;
    int32_t balance;
};

struct bodies {
    const struct asset_view *view;
    const struct asset_level *level;
    /* place: by vertex: index of the first vertex at its position; root: by that first vertex: parent in the union-find forest of connected
       vertices */
    uint32_t *place, *root;
    /* hash table of grid cells, to find vertices by position: 1 + index of a welded vertex (all vertices at nearly one position
       count as this vertex) in the cell; 0: free slot */
    uint32_t *table;
    float apart_m;
    size_t table_mask, edge_mask;
    struct edge_count *edges;
    uint8_t *open; /* by root of a body in the union-find forest: 1 if the body is open, else 0 */
};

static size_t power_above(size_t count)
{
    size_t power = 64;
    while (power < count)
        power *= 2;
    return power;
}

static bool bodies_init(struct bodies *bodies, size_t index_count)
{
    size_t vertices = bodies->level->vertex_count;
    bodies->table_mask = power_above(2 * vertices) - 1;
    bodies->edge_mask = power_above(index_count + index_count / 2) - 1;
    bodies->place = mem_try_array(vertices, sizeof(*bodies->place));
    bodies->root = mem_try_array(vertices, sizeof(*bodies->root));
    bodies->open = mem_try_array(vertices, sizeof(*bodies->open));
    bodies->table = mem_try_array(bodies->table_mask + 1, sizeof(*bodies->table));
    bodies->edges = mem_try_array(bodies->edge_mask + 1, sizeof(*bodies->edges));
    return bodies->place && bodies->root && bodies->open && bodies->table && bodies->edges;
}

static void bodies_finish(struct bodies *bodies)
{
    mem_free(bodies->place);
    mem_free(bodies->root);
    mem_free(bodies->open);
    mem_free(bodies->table);
    mem_free(bodies->edges);
}

static size_t slot_of(const struct bodies *bodies, const int32_t cell[3])
{
    return XXH3_64bits(cell, 3 * sizeof(*cell)) & bodies->table_mask;
}

/* Looks up one cell of the grid in which vertices are hashed. Returns the welded vertex at the given position in the cell, or UINT32_MAX if
   the cell has none. Cells are four times as wide as the welding distance, within which vertices share one position. */
static uint32_t find_place(const struct bodies *bodies, const int32_t cell[3], const float at[3])
{
    for (size_t slot = slot_of(bodies, cell); bodies->table[slot]; slot = (slot + 1) & bodies->table_mask) {
        const float *there = bodies->view->positions_m[bodies->table[slot] - 1];
        if (fabsf(there[0] - at[0]) <= bodies->apart_m && fabsf(there[1] - at[1]) <= bodies->apart_m &&
            fabsf(there[2] - at[2]) <= bodies->apart_m)
            return bodies->table[slot] - 1;
    }
    return UINT32_MAX;
}

/* Returns the welded vertex (one that represents all vertices at nearly its position) that the point belongs to, from the
   point's own grid cell or an adjacent cell whose border is within the welding distance. UINT32_MAX: none. */
static uint32_t find_place_near(const struct bodies *bodies, const float at[3], int32_t own[3])
{
    int32_t beside[3];
    for (int i = 0; i < 3; i++) {
        float x = at[i] / (4 * bodies->apart_m), part = x - floorf(x);
        own[i] = (int32_t)floorf(x);
        beside[i] = part < 0.26f ? own[i] - 1 : part > 0.74f ? own[i] + 1 : own[i];
    }
    for (int k = 0; k < 8; k++) {
        int32_t cell[3];
        /* true: along one axis, the adjacent cell is too far away to be searched, so this cell equals one that was already
           searched */
        bool again = false;
        for (int i = 0; i < 3; i++) {
            cell[i] = k >> i & 1 ? beside[i] : own[i];
            again |= (k >> i & 1) && beside[i] == own[i];
        }
        uint32_t found = again ? UINT32_MAX : find_place(bodies, cell, at);
        if (found != UINT32_MAX)
            return found;
    }
    return UINT32_MAX;
}

static void join_places(struct bodies *bodies)
{
    const struct asset_header *header = bodies->view->header;
    float size_m = 0;
    for (int i = 0; i < 3; i++)
        size_m = fmaxf(size_m, header->bounds_max_m[i] - header->bounds_min_m[i]);
    bodies->apart_m = fmaxf(WELD_PART * size_m, 1e-9f);
    for (uint32_t v = 0; v < bodies->level->vertex_count; v++) {
        int32_t cell[3];
        uint32_t found = find_place_near(bodies, bodies->view->positions_m[v], cell);
        bodies->place[v] = bodies->root[v] = found == UINT32_MAX ? v : found;
        if (found != UINT32_MAX)
            continue;
        size_t slot = slot_of(bodies, cell);
        while (bodies->table[slot])
            slot = (slot + 1) & bodies->table_mask;
        bodies->table[slot] = v + 1;
    }
}

static uint32_t root_of(struct bodies *bodies, uint32_t place)
{
    while (bodies->root[place] != place)
        place = bodies->root[place] = bodies->root[bodies->root[place]];
    return place;
}

static void count_edge(struct bodies *bodies, uint32_t from, uint32_t to)
{
    if (from == to)
        return;
    uint64_t ends = from < to ? (uint64_t)from << 32 | to : (uint64_t)to << 32 | from;
    size_t slot = XXH3_64bits(&ends, sizeof(ends)) & bodies->edge_mask;
    while (bodies->edges[slot].ends && bodies->edges[slot].ends != ends)
        slot = (slot + 1) & bodies->edge_mask;
    bodies->edges[slot].ends = ends;
    bodies->edges[slot].balance += from < to ? 1 : -1;
    bodies->root[root_of(bodies, from)] = root_of(bodies, to);
}

static bool is_opaque(const struct bodies *bodies, const struct asset_primitive *primitive)
{
    return bodies->view->materials[primitive->material].alpha == ASSET_ALPHA_OPAQUE;
}

static void count_edges(struct bodies *bodies)
{
    const struct asset_primitive *primitive = &bodies->view->primitives[bodies->level->first_primitive];
    for (uint32_t p = 0; p < bodies->level->primitive_count; p++, primitive++) {
        const uint32_t *at = bodies->view->indices + primitive->first_index;
        for (uint32_t i = 0; is_opaque(bodies, primitive) && i < primitive->index_count; i += 3)
            for (uint32_t k = 0; k < 3; k++)
                count_edge(bodies, bodies->place[at[i + k]], bodies->place[at[i + (k + 1) % 3]]);
    }
    for (size_t slot = 0; slot <= bodies->edge_mask; slot++)
        if (bodies->edges[slot].balance != 0)
            bodies->open[root_of(bodies, (uint32_t)bodies->edges[slot].ends)] = 1;
}

static void add_triangle(struct closed_bodies *out, uint32_t first_index)
{
    struct closed_run *last = out->run_count ? &out->runs[out->run_count - 1] : NULL;
    if (last && last->first_index + last->index_count == first_index) {
        last->index_count += 3;
        return;
    }
    mem_grow(&out->runs, &out->run_capacity, out->run_count + 1, sizeof(*out->runs));
    out->runs[out->run_count++] = (struct closed_run){ first_index, 3 };
}

static void collect(struct bodies *bodies, struct closed_bodies *out)
{
    const struct asset_primitive *primitive = &bodies->view->primitives[bodies->level->first_primitive];
    for (uint32_t p = 0; p < bodies->level->primitive_count; p++, primitive++)
        for (uint32_t i = 0; is_opaque(bodies, primitive) && i < primitive->index_count; i += 3)
            if (!bodies->open[root_of(bodies, bodies->place[bodies->view->indices[primitive->first_index + i]])])
                add_triangle(out, primitive->first_index + i);
}

void closed_bodies_find(const struct asset_view *view, uint32_t level, struct closed_bodies *out)
{
    struct bodies bodies = { .view = view, .level = &view->levels[level] };
    size_t index_count = 0;
    *out = (struct closed_bodies){ 0 };
    for (uint32_t p = 0; p < bodies.level->primitive_count; p++)
        index_count += view->primitives[bodies.level->first_primitive + p].index_count;
    if (index_count <= MAX_INDICES && bodies_init(&bodies, index_count)) {
        join_places(&bodies);
        count_edges(&bodies);
        collect(&bodies, out);
    }
    bodies_finish(&bodies);
}

void closed_bodies_finish(struct closed_bodies *closed)
{
    mem_free(closed->runs);
    *closed = (struct closed_bodies){ 0 };
}
