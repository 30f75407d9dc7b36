/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cache of what preparing reads from model files: the geometry hash of each asset cut out of a model, and the positions of nodes that
 * sensors are attached to. With it, an unchanged model need not be parsed again. The cache is the file FOLDER/cuts, which can be deleted at
 * any time. Thread: one. */
#ifndef PREPROCESS_CACHE_MODEL_CACHE_H
#define PREPROCESS_CACHE_MODEL_CACHE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The geometry hash (geometry_hash()) for a recipe (build_recipe(): model and cutting parameters). */
struct model_cache_geometry {
    uint64_t recipe;   /* result of build_recipe() */
    uint64_t geometry; /* result of geometry_hash() */
};
struct model_cache_node {
    uint64_t recipe, node_hash;
    double place_m[3]; /* asset frame */
};
struct model_cache {
    struct model_cache_geometry *at;
    struct model_cache_node *nodes;
    size_t count, node_count, capacity, node_capacity;
};

/* Reads the cache from the folder; a missing or damaged file gives an empty cache. Finish with model_cache_finish(). */
void model_cache_read(struct model_cache *cache, const char *folder);
/* Writes the cache to the folder, replacing the file. Returns 0 or -errno. */
int model_cache_write(const struct model_cache *cache, const char *folder);
/* Frees the lists and zeroes the cache. */
void model_cache_finish(struct model_cache *cache);

/* Returns whether both caches have equal entries in the same order. */
bool model_cache_same(const struct model_cache *a, const struct model_cache *b);
/* Looks up the geometry hash of a recipe. Returns false if the recipe is unknown. */
bool model_cache_find(const struct model_cache *cache, uint64_t recipe, uint64_t *geometry);
/* Looks up the position, in the asset frame in metres, of the node with this hash. Returns false if the node is unknown. */
bool model_cache_find_node(const struct model_cache *cache, uint64_t recipe, uint64_t node_hash, double place_m[3]);
/* Adds the geometry hash of a recipe. Does nothing if the recipe is known. */
void model_cache_add(struct model_cache *cache, uint64_t recipe, uint64_t geometry);
/* Adds a node's position. Does nothing if the node is known. */
void model_cache_add_node(struct model_cache *cache, uint64_t recipe, uint64_t node_hash, const double place_m[3]);

#endif
