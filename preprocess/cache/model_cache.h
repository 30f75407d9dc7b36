/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cache of what was read from model files: the geometry hash of each asset cut out of a model, and the positions of nodes that sensors are
   attached to. With it, an unchanged model need not be parsed again. In the file FOLDER/cuts; safe to delete. Thread: one. */
#ifndef PREPROCESS_CACHE_MODEL_CACHE_H
#define PREPROCESS_CACHE_MODEL_CACHE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The geometry hash (geometry_hash()) that a recipe (build_recipe(): model and parameters) leads to. */
struct model_cache_geometry {
    uint64_t recipe;   /* build_recipe */
    uint64_t geometry; /* geometry_hash */
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
/* Looks up the geometry hash of a recipe into *geometry. Returns false if it is not known. */
bool model_cache_find(const struct model_cache *cache, uint64_t recipe, uint64_t *geometry);
/* Looks up where the node named by node_hash is, in the asset frame, metres. Returns false if it is not known. */
bool model_cache_find_node(const struct model_cache *cache, uint64_t recipe, uint64_t node_hash, double place_m[3]);
/* Adds the geometry hash of a recipe, unless that recipe is there already. */
void model_cache_add(struct model_cache *cache, uint64_t recipe, uint64_t geometry);
/* Adds a node's position, unless that node is there already. */
void model_cache_add_node(struct model_cache *cache, uint64_t recipe, uint64_t node_hash, const double place_m[3]);

#endif
