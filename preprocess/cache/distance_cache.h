/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Distances that were found before, by the place that they start from: KEY.columns beside the asset files. Safe to delete; columns that
   are no good count as none. It grows to the most sensors that the asset ever had at once. */
#ifndef PREPROCESS_CACHE_DISTANCE_CACHE_H
#define PREPROCESS_CACHE_DISTANCE_CACHE_H
#include <stdatomic.h>
#include <stdint.h>

#include "surface/surface.h"

struct distance_cache {
    int fd;
    atomic_bool may_write;
    uint64_t key;
    size_t length; /* of a column */
    const double (*places_m)[3];
    size_t count;
    size_t *slots;      /* in the file, of each place; SIZE_MAX: none */
    atomic_size_t kept; /* places whose column was there */
};

/* places_m: where distances are wanted from; they must outlive it. Never fails: what cannot be read or written is not kept. */
void distance_cache_open(struct distance_cache *cache, const char *folder, uint64_t key, size_t length, const double (*places_m)[3],
                         size_t count);
void distance_cache_close(struct distance_cache *cache);
struct surface_columns distance_cache_for_surface(struct distance_cache *cache);

#endif
