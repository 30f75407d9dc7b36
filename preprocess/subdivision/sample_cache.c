/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stores projections of sample points in a hash table from point keys to triangle indices, 8 bytes per entry. The file holds the table in
 * the same layout, compressed. */
#include "preprocess/subdivision/sample_cache.h"

#include <string.h>

#include "base/mem.h"
#include "preprocess/cache/build_cache.h"
#include "surface/mesh/trimesh.h"

/* A hash table entry stores 1 + the triangle index in its TRI_BITS low bits, and the low bits of the key above them. The high
 * bits of the key select the slot. */
#define TRI_BITS 24
#define NOWHERE ((1u << TRI_BITS) - 1)
#define FULL 0.85
#define WORTH 0.5 /* share of a run's lookups; if the cache file answers fewer, it is rewritten */

void sample_cache_open(struct sample_cache *sample_cache, struct log *log, const char *folder, uint64_t key)
{
    *sample_cache = (struct sample_cache){ 0 };
    pthread_mutex_init(&sample_cache->lock, NULL);
    if (build_cache_open(&sample_cache->file, log, folder, BUILD_CACHE_SAMPLES, key)) {
        sample_cache->known = (const uint64_t *)(const void *)sample_cache->file.bytes;
        sample_cache->slot_count = sample_cache->file.count / sizeof(*sample_cache->known);
    }
}

void sample_cache_close(struct sample_cache *sample_cache)
{
    cache_file_close(&sample_cache->file);
    mem_free(sample_cache->asked);
    pthread_mutex_destroy(&sample_cache->lock);
    *sample_cache = (struct sample_cache){ 0 };
}

/* Returns the hash table slot with the key, or the empty slot for it if the key is absent. */
static size_t slot_of(const uint64_t *table, size_t count, uint64_t key)
{
    size_t slot = (size_t)((key >> 32) * count >> 32);
    for (size_t tries = 0; tries < count && table[slot] && table[slot] >> TRI_BITS != key << TRI_BITS >> TRI_BITS; tries++)
        slot = slot + 1 < count ? slot + 1 : 0;
    return slot;
}

bool sample_cache_find(const struct sample_cache *sample_cache, uint64_t key, uint32_t *tri)
{
    uint64_t found = sample_cache->slot_count ? sample_cache->known[slot_of(sample_cache->known, sample_cache->slot_count, key)] : 0;
    if (!found || found >> TRI_BITS != key << TRI_BITS >> TRI_BITS)
        return false;
    *tri = (found & NOWHERE) == NOWHERE ? TRIMESH_NONE : (uint32_t)(found & NOWHERE) - 1;
    return true;
}

void sample_cache_note(struct sample_cache *sample_cache, struct sample_cache_notes *notes, uint64_t key, uint32_t tri, bool known)
{
    if (notes->count == SAMPLE_CACHE_NOTES)
        sample_cache_hand_over(sample_cache, notes);
    notes->at[notes->count++] = (struct sample_cache_asked){ key, tri };
    notes->missed += !known;
}

void sample_cache_hand_over(struct sample_cache *sample_cache, struct sample_cache_notes *notes)
{
    if (notes->count == 0)
        return;
    pthread_mutex_lock(&sample_cache->lock);
    mem_grow(&sample_cache->asked, &sample_cache->asked_capacity, sample_cache->asked_count + notes->count, sizeof(*sample_cache->asked));
    memcpy(sample_cache->asked + sample_cache->asked_count, notes->at, notes->count * sizeof(*notes->at));
    sample_cache->asked_count += notes->count;
    sample_cache->missed_count += notes->missed;
    pthread_mutex_unlock(&sample_cache->lock);
    notes->count = notes->missed = 0;
}

void sample_cache_write(const struct sample_cache *sample_cache, const char *folder, uint64_t key)
{
    const size_t count = 16 + (size_t)((double)sample_cache->asked_count / FULL);
    if ((double)sample_cache->missed_count <= (1 - WORTH) * (double)sample_cache->asked_count)
        return;
    uint64_t *table = mem_array(count, sizeof(*table));
    for (size_t i = 0; i < sample_cache->asked_count; i++) {
        const struct sample_cache_asked *asked = &sample_cache->asked[i];
        if (asked->tri != TRIMESH_NONE && asked->tri >= NOWHERE - 1)
            continue;
        table[slot_of(table, count, asked->key)] = asked->key << TRI_BITS | (asked->tri == TRIMESH_NONE ? NOWHERE : asked->tri + 1);
    }
    build_cache_write(folder, BUILD_CACHE_SAMPLES, key, &(struct atomic_file_part){ table, count * sizeof(*table) }, 1);
    mem_free(table);
}
