/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Instants of the past that somebody looks at, each read from history once and shared. Thread: any. */
#ifndef VALUE_MOMENTS_H
#define VALUE_MOMENTS_H
#include "value/snapshot.h"

enum { MOMENTS_SPARE = 16 }; /* kept although nobody holds them, the newest */

struct moment { /* immutable while held */
    struct snapshot snapshot;
    int64_t at_us; /* UTC, since 1970; above 0 */
    int slot;      /* above 0; of two that are held, each has its own: fields and buffers of one do not disturb the other's */
};

struct moments;
struct moments *moments_create(void);
void moments_destroy(struct moments **moments); /* &NULL is fine; leaves NULL; nothing may be held any more */

/* Takes over the readings of the snapshot, which is left empty; their `changes` are made anew: equal where value and quality are. An
   instant that is there stays as it was. */
void moments_add(struct moments *moments, int64_t at_us, struct snapshot *snapshot);
/* Held until moments_give. NULL: not there (any more). */
const struct moment *moments_take(struct moments *moments, int64_t at_us);
void moments_give(struct moments *moments, const struct moment **moment); /* &NULL is fine; leaves NULL */

#endif
