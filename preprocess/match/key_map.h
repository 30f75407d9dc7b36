/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A hash map from keys to assets and nodes; several entries may have the same key. Call from one thread only while entries are
   added, any afterwards. */
#ifndef PREPROCESS_MATCH_KEY_MAP_H
#define PREPROCESS_MATCH_KEY_MAP_H
#include <stddef.h>

struct key_thing {
    char *key;
    /* asset: index of the asset that the key names; node: index of a node of the asset's model; -1: the key names the asset itself */
    int asset, node;
    int next;        /* index in `things` of the next entry in the same hash slot; -1: none */
};

struct key_map { /* zero-initialise */
    struct key_thing *things;
    int *slots;
    size_t count, capacity, slot_count;
};

/* Adds an entry to the map unless the same asset and node already have this key. Copies the key. */
void key_map_add(struct key_map *map, const char *key, int asset, int node);
/* Return the index of an entry with the key: key_map_find() returns the first one, key_map_next() the one after a given entry. -1: none. */
int key_map_find(const struct key_map *map, const char *key);
int key_map_next(const struct key_map *map, int thing);
void key_map_finish(struct key_map *map);

#endif
