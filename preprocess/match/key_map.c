/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hash table with chained entries. */
#include "preprocess/match/key_map.h"

#include <string.h>
#include <xxhash.h>

#include "base/mem.h"

static size_t slot_of(const struct key_map *map, const char *key)
{
    return (size_t)XXH3_64bits(key, strlen(key)) & (map->slot_count - 1);
}

static void grow(struct key_map *map)
{
    map->slot_count = map->slot_count ? map->slot_count * 2 : 1024;
    mem_free(map->slots);
    map->slots = mem_array(map->slot_count, sizeof(*map->slots));
    memset(map->slots, 0xff, map->slot_count * sizeof(*map->slots));
    /* inserts the entries from last to first, each at the front of its slot's list, so that the oldest entry with a key is
       found first */
    for (size_t i = map->count; i-- > 0;) {
        int *slot = &map->slots[slot_of(map, map->things[i].key)];
        map->things[i].next = *slot;
        *slot = (int)i;
    }
}

void key_map_add(struct key_map *map, const char *key, int asset, int node)
{
    for (int i = key_map_find(map, key); i >= 0; i = key_map_next(map, i))
        if (map->things[i].asset == asset && map->things[i].node == node)
            return;
    mem_grow(&map->things, &map->capacity, map->count + 1, sizeof(*map->things));
    map->things[map->count++] = (struct key_thing){ mem_strdup(key), asset, node, -1 };
    if (map->count * 2 > map->slot_count) {
        grow(map);
        return;
    }
    int *last = &map->slots[slot_of(map, key)];
    while (*last >= 0)
        last = &map->things[*last].next;
    *last = (int)map->count - 1;
}

static int with_key(const struct key_map *map, int thing, const char *key)
{
    while (thing >= 0 && strcmp(map->things[thing].key, key) != 0)
        thing = map->things[thing].next;
    return thing;
}

int key_map_find(const struct key_map *map, const char *key)
{
    return map->slot_count ? with_key(map, map->slots[slot_of(map, key)], key) : -1;
}

int key_map_next(const struct key_map *map, int thing)
{
    return with_key(map, map->things[thing].next, map->things[thing].key);
}

void key_map_finish(struct key_map *map)
{
    for (size_t i = 0; i < map->count; i++)
        mem_free(map->things[i].key);
    mem_free(map->things);
    mem_free(map->slots);
    *map = (struct key_map){ 0 };
}
