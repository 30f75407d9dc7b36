/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From keys to the things that have them: several things may have one key. Thread: one while it grows, then any. */
#ifndef PREPROCESS_MATCH_KEY_MAP_H
#define PREPROCESS_MATCH_KEY_MAP_H
#include <stddef.h>

struct key_thing {
    char *key;
    int asset, node; /* node -1: the asset itself */
    int next;        /* in things, of the same slot; -1: the last */
};

struct key_map { /* zero-initialise */
    struct key_thing *things;
    int *slots;
    size_t count, capacity, slot_count;
};

/* Adds a thing, unless the same asset and node have the key already. The key is copied. */
void key_map_add(struct key_map *map, const char *key, int asset, int node);
/* Returns the first thing with the key, or -1; key_map_next() the one after it. */
int key_map_find(const struct key_map *map, const char *key);
int key_map_next(const struct key_map *map, int thing);
void key_map_finish(struct key_map *map);

#endif
