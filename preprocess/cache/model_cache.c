/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and writes the model cache: one file with two lists, geometry hashes and node positions. */
#include "preprocess/cache/model_cache.h"

#include <string.h>

#include "base/files/pack.h"
#include "base/mem.h"
#include "preprocess/cache/build_cache.h"

void model_cache_read(struct model_cache *cache, struct log *log, const char *folder)
{
    struct cache_file kept;
    *cache = (struct model_cache){ 0 };
    if (build_cache_open(&kept, log, folder, BUILD_CACHE_MODELS, 0)) {
        struct unpack from = { .at = kept.bytes, .left = kept.count };
        cache->at = unpack_array(&from, &cache->count, sizeof(*cache->at));
        cache->nodes = unpack_array(&from, &cache->node_count, sizeof(*cache->nodes));
        cache->capacity = cache->count;
        cache->node_capacity = cache->node_count;
        if (from.bad)
            model_cache_finish(cache);
        cache_file_close(&kept);
    }
}

int model_cache_write(const struct model_cache *cache, const char *folder)
{
    struct text file = { 0 };
    pack_array(&file, cache->at, cache->count, sizeof(*cache->at));
    pack_array(&file, cache->nodes, cache->node_count, sizeof(*cache->nodes));
    int status = build_cache_write(folder, BUILD_CACHE_MODELS, 0, &(struct atomic_file_part){ file.at, file.length }, 1);
    text_finish(&file);
    return status;
}

void model_cache_finish(struct model_cache *cache)
{
    mem_free(cache->at);
    mem_free(cache->nodes);
    *cache = (struct model_cache){ 0 };
}

bool model_cache_same(const struct model_cache *a, const struct model_cache *b)
{
    return a->count == b->count && a->node_count == b->node_count && (!a->count || memcmp(a->at, b->at, a->count * sizeof(*a->at)) == 0) &&
           (!a->node_count || memcmp(a->nodes, b->nodes, a->node_count * sizeof(*a->nodes)) == 0);
}

bool model_cache_find(const struct model_cache *cache, uint64_t recipe, uint64_t *geometry)
{
    for (size_t i = 0; i < cache->count; i++)
        if (cache->at[i].recipe == recipe) {
            *geometry = cache->at[i].geometry;
            return true;
        }
    return false;
}

bool model_cache_find_node(const struct model_cache *cache, uint64_t recipe, uint64_t node_hash, double place_m[3])
{
    for (size_t i = 0; i < cache->node_count; i++)
        if (cache->nodes[i].recipe == recipe && cache->nodes[i].node_hash == node_hash) {
            memcpy(place_m, cache->nodes[i].place_m, sizeof(cache->nodes[i].place_m));
            return true;
        }
    return false;
}

void model_cache_add(struct model_cache *cache, uint64_t recipe, uint64_t geometry)
{
    if (model_cache_find(cache, recipe, &(uint64_t){ 0 }))
        return;
    mem_grow(&cache->at, &cache->capacity, cache->count + 1, sizeof(*cache->at));
    cache->at[cache->count++] = (struct model_cache_geometry){ recipe, geometry };
}

void model_cache_add_node(struct model_cache *cache, uint64_t recipe, uint64_t node_hash, const double place_m[3])
{
    double known_m[3];
    if (model_cache_find_node(cache, recipe, node_hash, known_m))
        return;
    mem_grow(&cache->nodes, &cache->node_capacity, cache->node_count + 1, sizeof(*cache->nodes));
    struct model_cache_node *node = &cache->nodes[cache->node_count++];
    *node = (struct model_cache_node){ .recipe = recipe, .node_hash = node_hash };
    memcpy(node->place_m, place_m, sizeof(node->place_m));
}
