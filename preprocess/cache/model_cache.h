/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What was found out about models that were read before, so that one that has not changed need not be read again: what each asset takes
   from it, and where the nodes are that sensors stand on. In the file FOLDER/cuts; safe to delete. Thread: one. */
#ifndef PREPROCESS_CACHE_MODEL_CACHE_H
#define PREPROCESS_CACHE_MODEL_CACHE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

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

void model_cache_read(struct model_cache *cache, const char *folder);       /* none is fine */
int model_cache_write(const struct model_cache *cache, const char *folder); /* 0 or -errno */
void model_cache_finish(struct model_cache *cache);

bool model_cache_same(const struct model_cache *a, const struct model_cache *b); /* order counts */
bool model_cache_find(const struct model_cache *cache, uint64_t recipe, uint64_t *geometry);
bool model_cache_find_node(const struct model_cache *cache, uint64_t recipe, uint64_t node_hash, double place_m[3]);
/* Unless it is there. */
void model_cache_add(struct model_cache *cache, uint64_t recipe, uint64_t geometry);
void model_cache_add_node(struct model_cache *cache, uint64_t recipe, uint64_t node_hash, const double place_m[3]);

#endif
