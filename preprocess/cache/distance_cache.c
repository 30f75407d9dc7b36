/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stores each column (distances from one sensor to all surface points) as a record: header and compressed distances. To
 * compress a column, takes differences between neighbouring points, separates their low and high bytes, and applies zstd. */
#include "preprocess/cache/distance_cache.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>
#include <zstd.h>

#include "base/mem.h"
#include "preprocess/cache/build_cache.h"
#include "preprocess/cache/file_io.h"
#include "protocol/asset_distance.h"

#define LEVEL 1          /* zstd compression level: level 3 would take twice the time and make the file no smaller */
#define RECORD_STEP 1024 /* sizes of records are multiples of this, so that another sensor's column usually fits a free record */

struct distance_record { /* header of a record; the compressed column follows */
    double place_m[3];   /* position of the record's sensor; NaN: the record is free */
    /* XXH3-64 of the file's key, the sensor's position and the compressed column; does not match if the record was only
     * partially written or belongs to another key */
    uint64_t checksum;
    uint32_t size, packed_bytes; /* sizes in bytes: record including header; compressed column */
};

/* --- compression ---------------------------------------------------------------------------------------------------------------- */

/* Returns the compressed column, or NULL if out of memory. The caller frees it. */
static void *pack(const uint16_t *codes, size_t length, size_t *packed_bytes)
{
    size_t bound = ZSTD_compressBound(2 * length);
    uint8_t *low = mem_try_array(length, 2), *high = low ? low + length : NULL;
    void *packed = mem_try_array(bound, 1);
    for (size_t i = 0; i < length && high && packed; i++) {
        /* zigzag coding: stores small differences of either sign as small numbers: 0, -1, 1, -2, ... become 0, 1, 2, 3, ... */
        const uint16_t difference = (uint16_t)(codes[i] - (i ? codes[i - 1] : 0));
        const uint16_t folded = (uint16_t)(difference << 1 ^ (difference & 0x8000 ? 0xffff : 0));
        low[i] = (uint8_t)folded;
        high[i] = (uint8_t)(folded >> 8);
    }
    if (!low || !packed || ZSTD_isError(*packed_bytes = ZSTD_compress(packed, bound, low, 2 * length, LEVEL))) {
        mem_free(packed);
        packed = NULL;
    }
    mem_free(low);
    return packed;
}

static bool unpack(const void *packed, size_t packed_bytes, float *distances_m, size_t length)
{
    uint8_t *low = mem_try_array(length, 2), *high = low ? low + length : NULL;
    uint16_t *codes = mem_try_array(length, sizeof(*codes));
    bool good = high && codes && ZSTD_decompress(low, 2 * length, packed, packed_bytes) == 2 * length;
    /* decodes in three separate loops, because the compiler can vectorise the first and the last one then */
    for (size_t i = 0; i < length && good; i++) {
        const uint16_t folded = (uint16_t)(low[i] | high[i] << 8);
        codes[i] = (uint16_t)(folded >> 1 ^ -(folded & 1));
    }
    for (size_t i = 1; i < length && good; i++)
        codes[i] = (uint16_t)(codes[i] + codes[i - 1]);
    for (size_t i = 0; i < length && good; i++)
        distances_m[i] = asset_distance_of(codes[i]);
    mem_free(low);
    mem_free(codes);
    return good;
}

/* --- records in the file -------------------------------------------------------------------------------------------------------- */

static size_t record_size(size_t packed_bytes)
{
    return (sizeof(struct distance_record) + packed_bytes + RECORD_STEP - 1) / RECORD_STEP * RECORD_STEP;
}

static uint64_t checksum_of(const struct distance_cache *cache, size_t place, const void *packed, size_t packed_bytes)
{
    uint64_t seed = XXH3_64bits_withSeed(cache->places_m[place], sizeof(cache->places_m[place]), cache->key);
    return XXH3_64bits_withSeed(packed, packed_bytes, seed);
}

/* Looks up the record of each sensor position in the cache file, and lists the free records. The list ends at the first record
 * with an impossible size; the file is truncated there. */
static void find_records(struct distance_cache *cache)
{
    struct stat st;
    const size_t file_bytes = fstat(cache->fd, &st) == 0 ? (size_t)st.st_size : 0;
    const size_t most = record_size(ZSTD_compressBound(2 * cache->length));
    struct distance_record record;
    while (cache->end < file_bytes) {
        bool used = false;
        if (!file_read(cache->fd, &record, sizeof(record), (off_t)cache->end) || record.size == 0 || record.size % RECORD_STEP != 0 ||
            record.size > most || record.packed_bytes > record.size - sizeof(record))
            break;
        for (size_t p = 0; p < cache->count && !used; p++)
            if (cache->records[p] == SIZE_MAX && memcmp(record.place_m, cache->places_m[p], sizeof(record.place_m)) == 0) {
                cache->records[p] = cache->end;
                used = true;
            }
        if (!used) {
            mem_grow(&cache->free, &cache->free_capacity, cache->free_count + 1, sizeof(*cache->free));
            cache->free[cache->free_count++] = (struct distance_space){ cache->end, record.size };
        }
        cache->end += record.size;
    }
    if (cache->end < file_bytes && ftruncate(cache->fd, (off_t)cache->end) != 0)
        cache->may_write = false;
}

/* Returns the offset of a free record of at least *size bytes, or else of a new one at the end. *size receives the record's actual size. */
static size_t reserve(struct distance_cache *cache, uint32_t *size)
{
    for (size_t i = 0; i < cache->free_count; i++)
        if (cache->free[i].size >= *size) {
            struct distance_space found = cache->free[i];
            cache->free[i] = cache->free[--cache->free_count];
            *size = found.size;
            return found.at;
        }
    cache->end += *size;
    return cache->end - *size;
}

void distance_cache_open(struct distance_cache *cache, struct log *log, const char *folder, uint64_t key, size_t length,
                         const double (*places_m)[3], size_t count)
{
    *cache = (struct distance_cache){ .log = log, .key = key, .length = length, .places_m = places_m, .count = count };
    pthread_mutex_init(&cache->lock, NULL);
    cache->path = build_cache_path(folder, BUILD_CACHE_DISTANCES, key);
    cache->fd = open(cache->path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    cache->may_write = cache->fd >= 0;
    if (cache->fd < 0)
        log_warn(log, "cache file %s: cannot be opened: %s; the distances will be recomputed", cache->path, strerror(errno));
    cache->records = mem_array(count, sizeof(*cache->records));
    for (size_t p = 0; p < count; p++)
        cache->records[p] = SIZE_MAX;
    if (cache->fd >= 0)
        find_records(cache);
}

void distance_cache_close(struct distance_cache *cache)
{
    if (!cache->path)
        return;
    if (cache->fd >= 0)
        close(cache->fd);
    if (cache->damaged > 0)
        log_warn(cache->log, "cache file %s: the distances from %zu sensors are damaged or incomplete and will be recomputed", cache->path,
                 cache->damaged);
    pthread_mutex_destroy(&cache->lock);
    mem_free(cache->path);
    mem_free(cache->records);
    mem_free(cache->free);
    *cache = (struct distance_cache){ 0 };
}

/* --- callbacks ------------------------------------------------------------------------------------------------------------------ */

static bool fetch(void *arg, size_t source, float *distances_m)
{
    struct distance_cache *cache = arg;
    struct distance_record record;
    const size_t at = cache->records[source];
    if (at == SIZE_MAX)
        return false;
    void *packed = NULL;
    bool good = file_read(cache->fd, &record, sizeof(record), (off_t)at) && (packed = mem_try_array(record.packed_bytes, 1)) &&
                file_read(cache->fd, packed, record.packed_bytes, (off_t)(at + sizeof(record))) &&
                record.checksum == checksum_of(cache, source, packed, record.packed_bytes) &&
                unpack(packed, record.packed_bytes, distances_m, cache->length);
    mem_free(packed);
    cache->kept += good;
    cache->damaged += !good;
    return good;
}

/* Writes a column to the file, and frees the record of a damaged column of the same sensor. Returns false if writing failed. */
static bool write_column(struct distance_cache *cache, size_t source, const void *packed, size_t packed_bytes)
{
    const double free_place = NAN;
    struct distance_record record = { .checksum = checksum_of(cache, source, packed, packed_bytes),
                                      .size = (uint32_t)record_size(packed_bytes),
                                      .packed_bytes = (uint32_t)packed_bytes };
    memcpy(record.place_m, cache->places_m[source], sizeof(record.place_m));
    pthread_mutex_lock(&cache->lock);
    bool good = cache->may_write;
    if (good && cache->records[source] != SIZE_MAX)
        good = file_write(cache->fd, &free_place, sizeof(free_place), (off_t)cache->records[source]);
    /* the header is written before the column, so that the list of records has no gap even if the program is killed */
    const size_t at = good ? reserve(cache, &record.size) : 0;
    good = good && file_write(cache->fd, &record, sizeof(record), (off_t)at);
    pthread_mutex_unlock(&cache->lock);
    return good && file_write(cache->fd, packed, packed_bytes, (off_t)(at + sizeof(record)));
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
    size_t packed_bytes = 0;
    void *packed = codes && cache->may_write ? pack(codes, cache->length, &packed_bytes) : NULL;
    /* after a failed write, write nothing more to the cache file; the partially written record has no valid checksum, so it counts as
     * absent */
    if (packed && !write_column(cache, source, packed, packed_bytes))
        cache->may_write = false;
    mem_free(packed);
    mem_free(codes);
}

struct surface_columns distance_cache_for_surface(struct distance_cache *cache)
{
    return (struct surface_columns){ fetch, keep, cache };
}
