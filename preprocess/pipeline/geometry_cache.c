/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Serialises and restores the parts of an asset that do not depend on sensors. */
#include "preprocess/pipeline/geometry_cache.h"

#include <string.h>

#include "base/files/compress.h"
#include "base/mem.h"
#include "preprocess/cache/build_cache.h"
#include "surface/surface_store.h"

/* --- reading ------------------------------------------------------------------------------------------------------------------ */

/* Starts reading a compressed cache file. finish() ends it. */
static struct unpack begin(const struct cache_file *file)
{
    struct decompressor *d = decompressor_create(file->bytes, file->count);
    return (struct unpack){ .left = d ? decompressor_left(d) : 0, .bad = !d, .compressed = d };
}

static bool finish(struct unpack *from)
{
    decompressor_destroy(&from->compressed);
    return !from->bad;
}

/* Reads the report, which is the first array of the cache file. */
static bool read_report(struct geometry_cache *cache)
{
    struct unpack from = begin(&cache->parts);
    unpack_into(&from, &cache->report, 1, sizeof(cache->report));
    return finish(&from);
}

bool geometry_cache_open(struct geometry_cache *cache, struct log *log, const char *folder, uint64_t key)
{
    *cache = (struct geometry_cache){ 0 };
    bool good = build_cache_map(&cache->parts, log, folder, BUILD_CACHE_GEOMETRY, key) &&
                build_cache_map(&cache->surface, log, folder, BUILD_CACHE_SURFACE, key) && read_report(cache);
    if (!good)
        geometry_cache_close(cache);
    return good;
}

void geometry_cache_close(struct geometry_cache *cache)
{
    cache_file_close(&cache->parts);
    cache_file_close(&cache->surface);
    *cache = (struct geometry_cache){ 0 };
}

/* --- the parts ---------------------------------------------------------------------------------------------------------------- */

struct geometry_numbers {
    double origin_m[3];
    uint32_t node_count, degenerate_triangles, turned_triangles, closed_gaps, computed_normals, skipped_lines, skipped_points;
};

static void pack_geometry(struct text *to, const struct geometry *g)
{
    const struct geometry_numbers numbers = { { g->origin_m[0], g->origin_m[1], g->origin_m[2] },
                                              g->node_count,
                                              g->degenerate_triangles,
                                              g->turned_triangles,
                                              g->closed_gaps,
                                              g->computed_normals,
                                              g->skipped_lines,
                                              g->skipped_points };
    pack_array(to, &numbers, 1, sizeof(numbers));
    pack_array(to, g->positions_m, g->vertex_count, sizeof(*g->positions_m));
    pack_array(to, g->normals, g->vertex_count, sizeof(*g->normals));
    pack_array(to, g->texcoords, g->texcoords ? g->vertex_count : 0, sizeof(*g->texcoords));
    pack_array(to, g->second_texcoords, g->second_texcoords ? g->vertex_count : 0, sizeof(*g->second_texcoords));
    pack_array(to, g->colors, g->colors ? g->vertex_count : 0, sizeof(*g->colors));
    pack_array(to, g->indices, g->index_count, sizeof(*g->indices));
    pack_array(to, g->primitives, g->primitive_count, sizeof(*g->primitives));
    pack_array(to, g->materials, g->material_count, sizeof(*g->materials));
    pack_array(to, g->textures, g->texture_count, sizeof(*g->textures));
    pack_array(to, g->texels, g->texel_bytes, 1);
    pack_array(to, g->names.at, g->names.length, 1);
}

/* Converts a count to 32 bits. If it does not fit, marks the cached data as damaged. */
static uint32_t narrow(struct unpack *from, size_t count)
{
    from->bad |= count > UINT32_MAX;
    return (uint32_t)count;
}

static void unpack_geometry(struct unpack *from, struct geometry *g)
{
    struct geometry_numbers numbers = { 0 };
    size_t positions, normals, texcoords, second_texcoords, colors, indices, primitives, materials, textures, name_bytes;
    unpack_into(from, &numbers, 1, sizeof(numbers));
    *g = (struct geometry){ .node_count = numbers.node_count,
                            .degenerate_triangles = numbers.degenerate_triangles,
                            .turned_triangles = numbers.turned_triangles,
                            .closed_gaps = numbers.closed_gaps,
                            .computed_normals = numbers.computed_normals,
                            .skipped_lines = numbers.skipped_lines,
                            .skipped_points = numbers.skipped_points };
    memcpy(g->origin_m, numbers.origin_m, sizeof(g->origin_m));
    g->positions_m = unpack_array(from, &positions, sizeof(*g->positions_m));
    g->normals = unpack_array(from, &normals, sizeof(*g->normals));
    g->texcoords = unpack_array(from, &texcoords, sizeof(*g->texcoords));
    g->second_texcoords = unpack_array(from, &second_texcoords, sizeof(*g->second_texcoords));
    g->colors = unpack_array(from, &colors, sizeof(*g->colors));
    g->indices = unpack_array(from, &indices, sizeof(*g->indices));
    g->primitives = unpack_array(from, &primitives, sizeof(*g->primitives));
    g->materials = unpack_array(from, &materials, sizeof(*g->materials));
    g->textures = unpack_array(from, &textures, sizeof(*g->textures));
    g->texels = unpack_array(from, &g->texel_bytes, 1);
    char *names = unpack_array(from, &name_bytes, 1);
    if (name_bytes)
        text_add_bytes(&g->names, names, name_bytes);
    mem_free(names);
    g->vertex_count = narrow(from, positions);
    g->index_count = narrow(from, indices);
    g->primitive_count = narrow(from, primitives);
    g->material_count = narrow(from, materials);
    g->texture_count = narrow(from, textures);
    from->bad |= normals != positions || (texcoords && texcoords != positions) || (second_texcoords && second_texcoords != positions) ||
                 (colors && colors != positions);
}

static void pack_levels(struct text *to, const struct levels *levels)
{
    float errors_m[LEVELS_MAX] = { 0 };
    for (size_t i = 0; i < levels->count; i++)
        errors_m[i] = levels->at[i].error_m;
    pack_array(to, errors_m, levels->count, sizeof(*errors_m));
    for (size_t i = 0; i < levels->count; i++) {
        pack_array(to, levels->at[i].indices, levels->at[i].index_count, sizeof(*levels->at[i].indices));
        pack_array(to, levels->at[i].primitives, levels->at[i].primitive_count, sizeof(*levels->at[i].primitives));
    }
}

static void unpack_levels(struct unpack *from, struct levels *levels)
{
    size_t indices, primitives;
    *levels = (struct levels){ 0 };
    float *errors_m = unpack_array(from, &levels->count, sizeof(*errors_m));
    from->bad |= levels->count > LEVELS_MAX;
    levels->count = from->bad ? 0 : levels->count;
    for (size_t i = 0; i < levels->count; i++) {
        struct level *level = &levels->at[i];
        level->error_m = errors_m[i];
        level->indices = unpack_array(from, &indices, sizeof(*level->indices));
        level->primitives = unpack_array(from, &primitives, sizeof(*level->primitives));
        level->index_count = level->whole_count = narrow(from, indices);
        level->primitive_count = narrow(from, primitives);
    }
    mem_free(errors_m);
}

void geometry_cache_pack(struct text *parts, const struct geometry *geometry, const struct levels *levels)
{
    pack_geometry(parts, geometry);
    pack_levels(parts, levels);
}

/* Reads geometry and levels of detail, which follow the report in the cache file. */
static bool read_parts(const struct geometry_cache *cache, struct geometry *geometry, struct levels *levels)
{
    struct unpack from = begin(&cache->parts);
    struct build_report report;
    unpack_into(&from, &report, 1, sizeof(report));
    unpack_geometry(&from, geometry);
    unpack_levels(&from, levels);
    return finish(&from);
}

static struct surface *read_surface(const struct geometry_cache *cache, struct log *log, struct workers *workers)
{
    struct unpack from = begin(&cache->surface);
    struct surface *surface = from.bad ? NULL : surface_unpack(&from, log, workers);
    finish(&from);
    return surface;
}

bool geometry_cache_unpack(const struct geometry_cache *cache, struct log *log, struct workers *workers, struct geometry *geometry,
                           struct levels *levels, struct surface **surface, enum build_cache_kind *damaged)
{
    const bool good = read_parts(cache, geometry, levels);
    *surface = good ? read_surface(cache, log, workers) : NULL;
    if (*surface)
        return true;
    *damaged = good ? BUILD_CACHE_SURFACE : BUILD_CACHE_GEOMETRY;
    levels_finish(levels);
    geometry_finish(geometry);
    return false;
}

/* --- writing ------------------------------------------------------------------------------------------------------------------ */

int geometry_cache_write(const char *folder, uint64_t key, const void *parts, size_t size, const struct build_report *report)
{
    struct text start = { 0 };
    pack_array(&start, report, 1, sizeof(*report));
    const struct atomic_file_part all[] = { { start.at, start.length }, { parts, size } };
    int status = build_cache_write(folder, BUILD_CACHE_GEOMETRY, key, all, sizeof(all) / sizeof(*all));
    text_finish(&start);
    return status;
}
