/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cache of geodesic distances by sensor position: the file KEY.columns in the folder of prepared files. One entry ("column") holds the
 * distances of all surface points from one sensor, in 16 bits each (protocol/asset_distance.h), compressed without loss. Computed distances
 * are rounded to the same precision, so that results do not depend on the cache. The file can be deleted at any time; damaged entries are
 * logged and count as absent. The file never shrinks; a new column replaces one that is no longer needed, if it fits there. */
#ifndef PREPROCESS_CACHE_DISTANCE_CACHE_H
#define PREPROCESS_CACHE_DISTANCE_CACHE_H
#include <pthread.h>
#include <stdatomic.h>
#include <stdint.h>

#include "base/log/log.h"
#include "surface/surface.h"

struct distance_space { /* byte range of the cache file that no sensor position's record uses */
    size_t at, size;
};

struct distance_cache {
    struct log *log;
    char *path;
    int fd;
    atomic_bool may_write;
    uint64_t key;
    size_t length; /* number of distances per sensor (column) */
    const double (*places_m)[3];
    size_t count;
    size_t *records; /* by sensor position: offset of the record with its column when the file was opened; SIZE_MAX: none */
    atomic_size_t kept; /* number of sensor positions whose column was found in the file */
    atomic_size_t damaged; /* number of sensor positions whose column in the file is damaged or incomplete */
    pthread_mutex_t lock;
    /* --- below: under lock --- */
    struct distance_space *free; /* byte ranges of records that belong to no present sensor position */
    size_t free_count, free_capacity, end; /* end: byte offset in the file after the last record */
};

/* Opens or creates FOLDER/KEY.columns and looks up which of the `count` sensor positions places_m (asset frame, metres; must outlive the
 * cache) have distances there. length: number of distances per sensor. Never fails: if the file cannot be opened, the cache is empty. */
void distance_cache_open(struct distance_cache *cache, struct log *log, const char *folder, uint64_t key, size_t length,
                         const double (*places_m)[3], size_t count);
/* Closes the cache file, logs how many sensors' distances in it were damaged, and frees the cache's arrays. A zeroed cache is allowed. */
void distance_cache_close(struct distance_cache *cache);
/* Returns callbacks for surface_field_init() that load the distances of cached sensors and store those newly computed. Valid
 * until distance_cache_close(). The callbacks may run on any thread, but at the same time only for different sources (sensors).
 * */
struct surface_columns distance_cache_for_surface(struct distance_cache *cache);

#endif
