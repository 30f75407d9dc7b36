/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cache of historical snapshots (readings of all tags at a past time). A time that users view is read from history once; all
   its users share the snapshot. Call from any thread. */
#ifndef VALUE_SNAPSHOT_CACHE_H
#define VALUE_SNAPSHOT_CACHE_H
#include "value/snapshot.h"

enum { SNAPSHOT_CACHE_SPARE = 16 }; /* maximum number of snapshots without a user that stay in the cache: the most recently used ones */

struct historical_snapshot { /* the readings of all tags at one past time; immutable while a user holds the snapshot */
    struct snapshot snapshot;
    int64_t at_us; /* UTC, since 1970; above 0 */
    /* slot number, from 1, unique among snapshots with a user; the renderer assigns its fields and buffers to snapshots by this number */
    int slot;
};

struct snapshot_cache;
struct snapshot_cache *snapshot_cache_create(void);
/* Frees the cache and sets *snapshot_cache to NULL. *snapshot_cache may be NULL. No snapshot may still be in use. */
void snapshot_cache_destroy(struct snapshot_cache **snapshot_cache);

/* Adds the snapshot of a past time and takes ownership of its readings, which leaves `snapshot` empty; the caller still frees the
   struct. Sets `changes` of the readings so that readings with equal values, qualities, alarms and ages have equal numbers. If the
   cache already has the time, changes nothing, and the caller keeps the readings. */
void snapshot_cache_add(struct snapshot_cache *snapshot_cache, int64_t at_us, struct snapshot *snapshot);
/* Returns the snapshot of a past time, valid until snapshot_cache_give(); NULL if the cache does not have it. */
const struct historical_snapshot *snapshot_cache_take(struct snapshot_cache *snapshot_cache, int64_t at_us);
void snapshot_cache_give(struct snapshot_cache *snapshot_cache,
                         /* Ends the use of a snapshot from snapshot_cache_take() and sets *historical to NULL. *historical may be NULL. */
                         const struct historical_snapshot **historical);

#endif
