/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stores each column (distances from one sensor to all surface points) in a file slot of fixed size: sensor position, checksum and
 * distances. */
#include "preprocess/cache/distance_cache.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include "base/mem.h"
#include "preprocess/cache/build_cache.h"
#include "preprocess/cache/file_io.h"
#include "protocol/asset_distance.h"

struct distance_slot { /* header of a slot (file range for one column); the column's distances follow */
    double place_m[3];
    /* XXH3-64 of the file's key, the sensor's position and the distances; wrong if the slot was only partially written or belongs to
     * another key */
    uint64_t checksum;
};

static size_t slot_bytes(const struct distance_cache *cache)
{
    return sizeof(struct distance_slot) + cache->length * sizeof(uint16_t);
}

static off_t slot_at(const struct distance_cache *cache, size_t slot)
{
    return (off_t)(slot * slot_bytes(cache));
}

static uint64_t checksum_of(const struct distance_cache *cache, size_t place, const uint16_t *codes)
{
    uint64_t seed = XXH3_64bits_withSeed(cache->places_m[place], sizeof(cache->places_m[place]), cache->key);
    return XXH3_64bits_withSeed(codes, cache->length * sizeof(*codes), seed);
}

/* Finds the slot (file range with one sensor's distances) of each sensor position in the cache file. A position without a slot gets an
 * unused slot, or a new one at the end of the file. */
static void deal_slots(struct distance_cache *cache)
{
    struct stat st;
    size_t there = fstat(cache->fd, &st) == 0 ? (size_t)st.st_size / slot_bytes(cache) : 0, next = 0;
    char *taken = mem_array(there, 1);
    for (size_t i = 0; i < there; i++) {
        struct distance_slot slot;
        if (!file_read(cache->fd, &slot, sizeof(slot), slot_at(cache, i)))
            continue;
        for (size_t p = 0; p < cache->count && !taken[i]; p++)
            if (cache->slots[p] == SIZE_MAX && memcmp(slot.place_m, cache->places_m[p], sizeof(slot.place_m)) == 0) {
                cache->slots[p] = i;
                taken[i] = 1;
            }
    }
    for (size_t p = 0; p < cache->count; p++) {
        if (cache->slots[p] != SIZE_MAX)
            continue;
        while (next < there && taken[next])
            next++;
        cache->slots[p] = next++;
    }
    mem_free(taken);
}

void distance_cache_open(struct distance_cache *cache, struct log *log, const char *folder, uint64_t key, size_t length,
                         const double (*places_m)[3], size_t count)
{
    *cache = (struct distance_cache){ .log = log, .key = key, .length = length, .places_m = places_m, .count = count };
    cache->path = build_cache_path(folder, BUILD_CACHE_DISTANCES, key);
    cache->fd = open(cache->path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    cache->may_write = cache->fd >= 0;
    if (cache->fd < 0)
        log_warn(log, "cache file %s: cannot be opened: %s; distances are computed again", cache->path, strerror(errno));
    cache->slots = mem_array(count, sizeof(*cache->slots));
    for (size_t p = 0; p < count; p++)
        cache->slots[p] = SIZE_MAX;
    deal_slots(cache); /* if the cache file could not be opened, deal_slots() only initialises the cache and assigns no slots */
}

void distance_cache_close(struct distance_cache *cache)
{
    if (!cache->path)
        return;
    if (cache->fd >= 0)
        close(cache->fd);
    if (cache->damaged > 0)
        log_warn(cache->log, "cache file %s: the distances of %zu sensors are damaged or incomplete; they are computed again", cache->path,
                 cache->damaged);
    mem_free(cache->path);
    mem_free(cache->slots);
    *cache = (struct distance_cache){ 0 };
}

static bool fetch(void *arg, size_t source, float *distances_m)
{
    struct distance_cache *cache = arg;
    struct distance_slot slot;
    off_t at = slot_at(cache, cache->slots[source]);
    uint16_t *codes = mem_try_array(cache->length, sizeof(*codes));
    bool there = codes && file_read(cache->fd, &slot, sizeof(slot), at) &&
                 memcmp(slot.place_m, cache->places_m[source], sizeof(slot.place_m)) == 0;
    bool good = there && file_read(cache->fd, codes, cache->length * sizeof(*codes), at + (off_t)sizeof(slot)) &&
                slot.checksum == checksum_of(cache, source, codes);
    for (size_t i = 0; i < cache->length && good; i++)
        distances_m[i] = asset_distance_of(codes[i]);
    mem_free(codes);
    cache->kept += good;
    cache->damaged += there && !good;
    return good;
}

static void keep(void *arg, size_t source, float *distances_m)
{
    struct distance_cache *cache = arg;
    uint16_t *codes = mem_try_array(cache->length, sizeof(*codes));
    for (size_t i = 0; i < cache->length; i++) {
        uint16_t code = asset_distance_code(distances_m[i]);
        distances_m[i] = asset_distance_of(code);
        if (codes)
            codes[i] = code;
    }
    if (!codes)
        return;
    struct distance_slot slot = { .checksum = checksum_of(cache, source, codes) };
    off_t at = slot_at(cache, cache->slots[source]);
    memcpy(slot.place_m, cache->places_m[source], sizeof(slot.place_m));
    if (!cache->may_write || !file_write(cache->fd, &slot, sizeof(slot), at) ||
        !file_write(cache->fd, codes, cache->length * sizeof(*codes), at + (off_t)sizeof(slot)))
        /* after a failed write, write nothing more to the cache file; the partially written slot has no valid checksum, so it counts as
         * absent */
        cache->may_write = false;
    mem_free(codes);
}

struct surface_columns distance_cache_for_surface(struct distance_cache *cache)
{
    return (struct surface_columns){ fetch, keep, cache };
}
