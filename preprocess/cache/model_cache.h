/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Caches what plantcast-prep reads from model files: the geometry hash of each asset cut out of a model, and the positions of
 * nodes that sensors are attached to. With this cache, an unchanged model need not be parsed again. The cache is the file
 * FOLDER/cuts, which can be deleted at any time. Call from one thread only. */
#ifndef PREPROCESS_CACHE_MODEL_CACHE_H
#define PREPROCESS_CACHE_MODEL_CACHE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log/log.h"

/* Maps a recipe to a geometry hash (geometry_hash()). A recipe is the hash of a model and of the parameters that cut an asset
 * out of the model (build_recipe()). */
struct model_cache_geometry {
    uint64_t recipe;   /* hash of a model and of the parameters with which an asset is cut out (build_recipe()) */
    uint64_t geometry; /* hash of the geometry cut out of the model (geometry_hash()) */
};
struct model_cache_node {
    uint64_t recipe, node_hash;
    double place_m[3]; /* position of the node in the asset frame, metres */
};
struct model_cache {
    struct model_cache_geometry *at;
    struct model_cache_node *nodes;
    size_t count, node_count, capacity, node_capacity;
};

/* Reads the model cache from the folder of prepared files; a missing or damaged file gives an empty cache. Finish with
 * model_cache_finish(). */
void model_cache_read(struct model_cache *cache, struct log *log, const char *folder);
/* Writes the model cache to the folder of prepared files, replacing its file. Returns 0 or -errno. */
int model_cache_write(const struct model_cache *cache, const char *folder);
/* Frees both lists of the model cache and zeroes it. */
void model_cache_finish(struct model_cache *cache);

/* Returns whether the two model caches have equal entries in the same order. */
bool model_cache_same(const struct model_cache *a, const struct model_cache *b);
/* Looks up the geometry hash of a recipe (hash of model and cutting parameters). Returns false if the cache does not contain it. */
bool model_cache_find(const struct model_cache *cache, uint64_t recipe, uint64_t *geometry);
/* Looks up the position (asset frame, metres) of the node whose name has this hash in the asset with this recipe. Returns false
 * if the cache does not contain it. */
bool model_cache_find_node(const struct model_cache *cache, uint64_t recipe, uint64_t node_hash, double place_m[3]);
/* Adds the geometry hash of a recipe (hash of model and cutting parameters), unless the cache already contains the recipe. */
void model_cache_add(struct model_cache *cache, uint64_t recipe, uint64_t geometry);
/* Adds the position of a node (by recipe and hash of the node's name), unless the cache already contains the node. */
void model_cache_add_node(struct model_cache *cache, uint64_t recipe, uint64_t node_hash, const double place_m[3]);

#endif
