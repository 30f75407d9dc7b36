/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Snapshots that are kept as baselines, so that views can show the difference from them: some under a name that a session chose, others
   known by their time alone. Ids increase and are never reused, so a forgotten baseline is not mistaken for a newer one. Thread: any. */
#ifndef VALUE_BASELINES_H
#define VALUE_BASELINES_H
#include <stdbool.h>

#include "value/snapshot.h"

enum { BASELINES_NAMED = 32, BASELINES_UNNAMED = 32, BASELINE_NAME_BYTES = 64 };

struct baseline {                   /* the description of one */
    uint32_t id;                    /* 0: none */
    char name[BASELINE_NAME_BYTES]; /* "": unnamed, known by its time */
    int64_t taken_utc_ns;
};

struct baselines;
struct baselines *baselines_create(void);
void baselines_destroy(struct baselines **baselines); /* &NULL is fine; leaves NULL */

/* Stores a copy of the snapshot under a name and returns its id. A baseline of that name is replaced under the same id, for every view that
   shows it. Returns 0 if there are BASELINES_NAMED others already. */
uint32_t baselines_set(struct baselines *baselines, const char *name, const struct snapshot *snapshot);
/* Stores an unnamed copy of the snapshot and returns its id; the oldest unnamed one is dropped. The same instant is stored once. */
uint32_t baselines_keep(struct baselines *baselines, const struct snapshot *snapshot);
void baselines_remove(struct baselines *baselines, const char *name);
uint32_t baselines_find(struct baselines *baselines, const char *name);                  /* returns its id; 0: none */
bool baselines_may_set(struct baselines *baselines, const char *name);                   /* returns whether it has room for that name */
bool baselines_describe(struct baselines *baselines, uint32_t id, struct baseline *out); /* returns false if it was dropped */
/* Lists the named baselines, oldest first, and returns how many there are. */
size_t baselines_list(struct baselines *baselines, struct baseline out[BASELINES_NAMED]);

/* Returns the snapshot of a baseline, which stays valid until baselines_give(); NULL if it was dropped. */
const struct snapshot *baselines_take(struct baselines *baselines, uint32_t id);
void baselines_give(struct baselines *baselines, const struct snapshot **snapshot); /* &NULL is fine; leaves NULL */

#endif
