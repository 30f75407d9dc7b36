/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cache of historical snapshots: each instant that somebody looks at is read from history once and shared. Thread: any. */
#ifndef VALUE_SNAPSHOT_CACHE_H
#define VALUE_SNAPSHOT_CACHE_H
#include "value/snapshot.h"

enum { SNAPSHOT_CACHE_SPARE = 16 }; /* this many of the newest stay although nobody uses them */

struct historical_snapshot { /* immutable while held */
    struct snapshot snapshot;
    int64_t at_us; /* UTC, since 1970; above 0 */
    int slot;      /* above 0; unique among those in use, so that each has its own fields and buffers */
};

struct snapshot_cache;
struct snapshot_cache *snapshot_cache_create(void);
void snapshot_cache_destroy(struct snapshot_cache **snapshot_cache); /* &NULL is fine; leaves NULL; nothing may be held any more */

/* Adds an instant. Renumbers the `changes` of the snapshot's readings so that equal values and qualities have equal numbers, and takes the
   readings over, which leaves the snapshot empty. An instant that is already there stays as it was, and the caller keeps the readings. The
   struct itself stays the caller's. */
void snapshot_cache_add(struct snapshot_cache *snapshot_cache, int64_t at_us, struct snapshot *snapshot);
/* Returns the snapshot of an instant, which stays valid until snapshot_cache_give(); NULL if it is not in the cache. */
const struct historical_snapshot *snapshot_cache_take(struct snapshot_cache *snapshot_cache, int64_t at_us);
void snapshot_cache_give(struct snapshot_cache *snapshot_cache,
                         const struct historical_snapshot **historical); /* &NULL is fine; leaves NULL */

#endif
