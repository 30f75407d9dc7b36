/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cache of historical snapshots: each instant that is viewed is read from history once and shared. Thread: any. */
#ifndef VALUE_SNAPSHOT_CACHE_H
#define VALUE_SNAPSHOT_CACHE_H
#include "value/snapshot.h"

enum { SNAPSHOT_CACHE_SPARE = 16 }; /* number of snapshots without a user that stay in the cache, the newest ones */

struct historical_snapshot { /* immutable while a user holds it */
    struct snapshot snapshot;
    int64_t at_us; /* UTC, since 1970; above 0 */
    /* slot number, from 1, unique among snapshots in use: it tells the renderer which fields and buffers belong to this snapshot */
    int slot;
};

struct snapshot_cache;
struct snapshot_cache *snapshot_cache_create(void);
/* Frees the cache; no snapshot may be in use any more. &NULL is fine; leaves NULL. */
void snapshot_cache_destroy(struct snapshot_cache **snapshot_cache);

/* Adds the snapshot of an instant. Sets the `changes` of its readings so that equal values and qualities have equal numbers, and takes
   ownership of the readings, leaving the snapshot empty. If the instant is already cached, that entry stays unchanged and the caller
   keeps the readings. The struct itself remains the caller's. */
void snapshot_cache_add(struct snapshot_cache *snapshot_cache, int64_t at_us, struct snapshot *snapshot);
/* Returns the snapshot of an instant, valid until snapshot_cache_give(); NULL if it is not in the cache. */
const struct historical_snapshot *snapshot_cache_take(struct snapshot_cache *snapshot_cache, int64_t at_us);
void snapshot_cache_give(struct snapshot_cache *snapshot_cache,
                         /* Ends the use of a snapshot from snapshot_cache_take(). &NULL is fine; leaves NULL. */
                         const struct historical_snapshot **historical);

#endif
