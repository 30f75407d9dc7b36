/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Instants of the past that somebody looks at, each read from history once and shared. Thread: any. */
#ifndef VALUE_SNAPSHOT_CACHE_H
#define VALUE_SNAPSHOT_CACHE_H
#include "value/snapshot.h"

enum { SNAPSHOT_CACHE_SPARE = 16 }; /* kept although nobody holds them, the newest */

struct historical_snapshot { /* immutable while held */
    struct snapshot snapshot;
    int64_t at_us; /* UTC, since 1970; above 0 */
    int slot;      /* above 0; of two that are held, each has its own: fields and buffers of one do not disturb the other's */
};

struct snapshot_cache;
struct snapshot_cache *snapshot_cache_create(void);
void snapshot_cache_destroy(struct snapshot_cache **snapshot_cache); /* &NULL is fine; leaves NULL; nothing may be held any more */

/* Takes over the readings of the snapshot, which is left empty; their `changes` are made anew: equal where value and quality are. An
   instant that is there stays as it was. */
void snapshot_cache_add(struct snapshot_cache *snapshot_cache, int64_t at_us, struct snapshot *snapshot);
/* Held until snapshot_cache_give. NULL: not there (any more). */
const struct historical_snapshot *snapshot_cache_take(struct snapshot_cache *snapshot_cache, int64_t at_us);
void snapshot_cache_give(struct snapshot_cache *snapshot_cache,
                         const struct historical_snapshot **historical); /* &NULL is fine; leaves NULL */

#endif
