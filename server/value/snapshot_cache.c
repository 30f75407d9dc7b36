/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Caches snapshots of past times (readings of all tags) in a short list, with reference counts. */
#include "value/snapshot_cache.h"

#include <pthread.h>
#include <stdbool.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "base/mem.h"

/* The snapshot must be the first member: users hold a pointer to it, which is converted back to a pointer to this struct. */
struct snapshot_entry {
    struct historical_snapshot historical;
    int users;
    uint64_t used;
};

struct snapshot_cache {
    pthread_mutex_t lock;
    /* --- below: under lock */
    struct snapshot_entry **entries;
    size_t count, capacity;
    uint64_t uses;
};

struct snapshot_cache *snapshot_cache_create(void)
{
    struct snapshot_cache *snapshot_cache = mem_new(sizeof(*snapshot_cache));
    pthread_mutex_init(&snapshot_cache->lock, NULL);
    return snapshot_cache;
}

static void entry_destroy(struct snapshot_entry *entry)
{
    mem_free(entry->historical.snapshot.readings);
    mem_free(entry);
}

void snapshot_cache_destroy(struct snapshot_cache **cache_ptr)
{
    struct snapshot_cache *snapshot_cache = *cache_ptr;
    if (!snapshot_cache)
        return;
    for (size_t i = 0; i < snapshot_cache->count; i++)
        entry_destroy(snapshot_cache->entries[i]);
    mem_free(snapshot_cache->entries);
    pthread_mutex_destroy(&snapshot_cache->lock);
    mem_free(snapshot_cache);
    *cache_ptr = NULL;
}

/* Returns the cache entry of a past time, or NULL. Call with the lock held. */
static struct snapshot_entry *find(const struct snapshot_cache *snapshot_cache, int64_t at_us)
{
    for (size_t i = 0; i < snapshot_cache->count; i++)
        if (snapshot_cache->entries[i]->historical.at_us == at_us)
            return snapshot_cache->entries[i];
    return NULL;
}

/* Returns the lowest slot number that no snapshot in use has. Call with the lock held. */
static int free_slot(const struct snapshot_cache *snapshot_cache)
{
    for (int slot = 1;; slot++) {
        bool taken = false;
        for (size_t i = 0; i < snapshot_cache->count && !taken; i++)
            taken = snapshot_cache->entries[i]->users > 0 && snapshot_cache->entries[i]->historical.slot == slot;
        if (!taken)
            return slot;
    }
}

/* If more than SNAPSHOT_CACHE_SPARE snapshots have no user, frees the least recently used one. Call with the lock held. */
static void drop_spare(struct snapshot_cache *snapshot_cache)
{
    size_t spare = 0, oldest = 0;
    for (size_t i = 0; i < snapshot_cache->count; i++) {
        const struct snapshot_entry *entry = snapshot_cache->entries[i];
        if (entry->users > 0)
            continue;
        if (spare++ == 0 || entry->used < snapshot_cache->entries[oldest]->used)
            oldest = i;
    }
    if (spare <= SNAPSHOT_CACHE_SPARE)
        return;
    entry_destroy(snapshot_cache->entries[oldest]);
    snapshot_cache->entries[oldest] = snapshot_cache->entries[--snapshot_cache->count];
}

static void number_changes(struct snapshot *snapshot)
{
    for (size_t i = 0; i < snapshot->count; i++) {
        struct reading *reading = &snapshot->readings[i];
        struct {
            double value;
            int64_t age_ns; /* differs between instants even if value and quality are equal */
            uint32_t quality, alarm;
        } what = { reading->value, reading->age_ns, reading->quality, 0 };
        what.alarm = (uint32_t)reading->alarm << 8 | reading->alarm_status;
        reading->changes = (uint32_t)XXH3_64bits(&what, sizeof(what));
    }
}

void snapshot_cache_add(struct snapshot_cache *snapshot_cache, int64_t at_us, struct snapshot *snapshot)
{
    number_changes(snapshot);
    pthread_mutex_lock(&snapshot_cache->lock);
    if (!find(snapshot_cache, at_us)) {
        struct snapshot_entry *entry = mem_new(sizeof(*entry));
        *entry = (struct snapshot_entry){ .historical = { .snapshot = *snapshot, .at_us = at_us }, .used = ++snapshot_cache->uses };
        *snapshot = (struct snapshot){ 0 };
        mem_grow(&snapshot_cache->entries, &snapshot_cache->capacity, snapshot_cache->count + 1, sizeof(*snapshot_cache->entries));
        snapshot_cache->entries[snapshot_cache->count++] = entry;
        drop_spare(snapshot_cache);
    }
    pthread_mutex_unlock(&snapshot_cache->lock);
}

const struct historical_snapshot *snapshot_cache_take(struct snapshot_cache *snapshot_cache, int64_t at_us)
{
    pthread_mutex_lock(&snapshot_cache->lock);
    struct snapshot_entry *entry = find(snapshot_cache, at_us);
    if (entry) {
        if (entry->users == 0)
            entry->historical.slot = free_slot(snapshot_cache);
        entry->users++;
        entry->used = ++snapshot_cache->uses;
    }
    pthread_mutex_unlock(&snapshot_cache->lock);
    return entry ? &entry->historical : NULL;
}

void snapshot_cache_give(struct snapshot_cache *snapshot_cache, const struct historical_snapshot **historical)
{
    if (!*historical)
        return;
    pthread_mutex_lock(&snapshot_cache->lock);
    ((struct snapshot_entry *)*historical)->users--;
    drop_spare(snapshot_cache);
    pthread_mutex_unlock(&snapshot_cache->lock);
    *historical = NULL;
}
