/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Instants that are kept, to show how the field differs from them: some by a name that sessions chose, some by their time alone.
   Numbers count up and are never used again: what was forgotten is not mistaken for something newer. Thread: any. */
#ifndef VALUE_BASELINES_H
#define VALUE_BASELINES_H
#include <stdbool.h>

#include "value/snapshot.h"

enum { BASELINES_NAMED = 32, BASELINES_UNNAMED = 32, BASELINE_NAME_BYTES = 64 };

struct baseline {                   /* what one is called */
    uint32_t id;                    /* 0: none */
    char name[BASELINE_NAME_BYTES]; /* "": known by its time */
    int64_t taken_utc_ns;
};

struct baselines;
struct baselines *baselines_create(void);
void baselines_destroy(struct baselines **baselines); /* &NULL is fine; leaves NULL */

/* Keeps a copy. What the name meant before is replaced for all who show it, under the same id. 0: BASELINES_NAMED others are kept. */
uint32_t baselines_set(struct baselines *baselines, const char *name, const struct snapshot *snapshot);
/* Keeps a copy known by its time; the oldest such one goes. The same instant is kept once. */
uint32_t baselines_keep(struct baselines *baselines, const struct snapshot *snapshot);
void baselines_remove(struct baselines *baselines, const char *name);
uint32_t baselines_find(struct baselines *baselines, const char *name);                  /* 0: none */
bool baselines_may_set(struct baselines *baselines, const char *name);                   /* room is left, or the name is there */
bool baselines_describe(struct baselines *baselines, uint32_t id, struct baseline *out); /* false: forgotten */
/* Those with names, oldest first; how many. */
size_t baselines_list(struct baselines *baselines, struct baseline out[BASELINES_NAMED]);

/* The readings of one, held until baselines_give. NULL: forgotten. */
const struct snapshot *baselines_take(struct baselines *baselines, uint32_t id);
void baselines_give(struct baselines *baselines, const struct snapshot **snapshot); /* &NULL is fine; leaves NULL */

#endif
