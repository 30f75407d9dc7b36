/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sorts vertices by level of detail, coarsest first, and within it by their use in triangles. */
#include "preprocess/levels/vertex_order.h"

#include <string.h>

#include "base/mem.h"

#define BINS (2 * LEVELS_MAX)

/* bins[vertex]: twice the number of the coarsest level of detail that uses the vertex (0: the coarsest of all); plus one for
 * vertices added by subdivision. The value BINS marks an added vertex that only dropped levels used. */
static void find_bins(const struct levels *levels, uint32_t vertex_count, uint32_t first_added, uint8_t *bins)
{
    for (uint32_t v = 0; v < vertex_count; v++)
        bins[v] = v < first_added ? (uint8_t)(2 * (levels->count - 1)) : BINS;
    for (size_t l = 0; l < levels->count; l++)
        for (uint32_t i = 0; i < levels->at[l].index_count; i++) {
            uint32_t v = levels->at[l].indices[i];
            bins[v] = (uint8_t)(2 * (levels->count - 1 - l) + (v >= first_added));
        }
}

/* Renumbers the vertices in the order of their bins (find_bins()), and within a bin in the order in which triangles use them.
 * Vertices with neighbouring numbers are then close together, so that their distances take fewer bits
 * (protocol/distance_pack.h). Returns the number of vertices kept. */
static uint32_t number_vertices(const struct levels *levels, uint32_t vertex_count, const uint8_t *bins, struct asset_level *out,
                                uint32_t *new_of)
{
    uint32_t next[BINS + 2] = { 0 }, kept;
    for (uint32_t v = 0; v < vertex_count; v++) {
        next[bins[v] + 1]++;
        new_of[v] = TRIMESH_NONE;
    }
    for (size_t l = 0; l < levels->count; l++)
        out[l].added_count = next[2 * (levels->count - 1 - l) + 2];
    for (int b = 1; b <= BINS; b++)
        next[b] += next[b - 1];
    kept = next[BINS];
    for (size_t l = 0; l < levels->count; l++)
        out[l].vertex_count = next[2 * (levels->count - l)];
    for (size_t l = 0; l < levels->count; l++)
        for (uint32_t i = 0; i < levels->at[l].index_count; i++) {
            uint32_t v = levels->at[l].indices[i];
            if (new_of[v] == TRIMESH_NONE)
                new_of[v] = next[bins[v]]++;
        }
    for (uint32_t v = 0; v < vertex_count; v++)
        if (new_of[v] == TRIMESH_NONE && bins[v] != BINS)
            new_of[v] = next[bins[v]]++;
    return kept;
}

static void *moved(const void *from, size_t bytes_each, uint32_t count, const uint32_t *new_of, uint32_t kept)
{
    char *to = from ? mem_array(kept, bytes_each) : NULL;
    for (uint32_t v = 0; from && v < count; v++)
        if (new_of[v] != TRIMESH_NONE)
            memcpy(to + new_of[v] * bytes_each, (const char *)from + v * bytes_each, bytes_each);
    return to;
}

static void replace(void *array_ptr, void *by)
{
    void **array = array_ptr;
    mem_free(*array);
    *array = by;
}

static void join_levels(struct geometry *g, const struct levels *levels, const uint32_t *new_of, struct asset_level *out)
{
    uint32_t indices = 0, primitives = 0;
    for (size_t l = 0; l < levels->count; l++) {
        indices += levels->at[l].index_count;
        primitives += levels->at[l].primitive_count;
    }
    replace(&g->indices, mem_array(indices, sizeof(*g->indices)));
    replace(&g->primitives, mem_array(primitives, sizeof(*g->primitives)));
    g->index_count = g->primitive_count = 0;
    for (size_t l = 0; l < levels->count; l++) {
        const struct level *level = &levels->at[l];
        out[l].first_primitive = g->primitive_count;
        out[l].primitive_count = level->primitive_count;
        out[l].error_m = level->error_m;
        for (uint32_t p = 0; p < level->primitive_count; p++) {
            g->primitives[g->primitive_count] = level->primitives[p];
            g->primitives[g->primitive_count++].first_index += g->index_count;
        }
        for (uint32_t i = 0; i < level->index_count; i++)
            g->indices[g->index_count++] = new_of[level->indices[i]];
    }
}

bool vertex_order_apply(struct geometry *geometry, const struct levels *levels, uint32_t first_added, struct asset_level out[LEVELS_MAX],
                        uint32_t **new_of)
{
    uint32_t count = geometry->vertex_count;
    uint8_t *bins = mem_try_array(count, sizeof(*bins));
    *new_of = mem_try_array(count, sizeof(**new_of));
    bool good = bins && *new_of;
    if (good) {
        find_bins(levels, count, first_added, bins);
        uint32_t kept = number_vertices(levels, count, bins, out, *new_of);
        replace(&geometry->positions_m, moved(geometry->positions_m, sizeof(*geometry->positions_m), count, *new_of, kept));
        replace(&geometry->normals, moved(geometry->normals, sizeof(*geometry->normals), count, *new_of, kept));
        replace(&geometry->texcoords, moved(geometry->texcoords, sizeof(*geometry->texcoords), count, *new_of, kept));
        replace(&geometry->second_texcoords, moved(geometry->second_texcoords, sizeof(*geometry->second_texcoords), count, *new_of, kept));
        replace(&geometry->colors, moved(geometry->colors, sizeof(*geometry->colors), count, *new_of, kept));
        join_levels(geometry, levels, *new_of, out);
        geometry->vertex_count = kept;
    }
    mem_free(bins);
    return good;
}
