/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Baselines: saved readings of all tags. A view can show the difference between the current readings and a baseline. Users save
   named baselines; unnamed ones are identified by the time of their readings alone. Ids increase and are never reused, so the
   id of a dropped baseline never names a newer one. Call from any thread. */
#ifndef VALUE_BASELINES_H
#define VALUE_BASELINES_H
#include <stdbool.h>

#include "value/snapshot.h"

enum { BASELINES_NAMED = 32, BASELINES_UNNAMED = 32, BASELINE_NAME_BYTES = 64 };

struct baseline {                   /* description of one baseline */
    uint32_t id;                    /* baseline id; 0: none */
    char name[BASELINE_NAME_BYTES]; /* name of the baseline; "": it is unnamed, and its time identifies it */
    int64_t taken_utc_ns;
};

struct baselines;
struct baselines *baselines_create(void);
void baselines_destroy(struct baselines **baselines); /* Frees the baselines and sets *baselines to NULL. *baselines may be NULL. */

/* Stores a copy of the snapshot as a baseline with this name and returns its id. An existing baseline with the name is replaced
   and keeps its id, so that views that show it use the new readings. Returns 0 if BASELINES_NAMED other names are in use. */
uint32_t baselines_set(struct baselines *baselines, const char *name, const struct snapshot *snapshot);
/* Stores a copy of the snapshot as an unnamed baseline and returns its id; the oldest unnamed baseline is dropped if there are too many.
   Readings of one time are stored only once. */
uint32_t baselines_keep(struct baselines *baselines, const struct snapshot *snapshot);
void baselines_remove(struct baselines *baselines, const char *name);
uint32_t baselines_find(struct baselines *baselines, const char *name); /* Returns the id of the baseline with this name; 0: none. */
/* Returns true if baselines_set() would accept this name: it is in use, or another named baseline can be added. */
bool baselines_may_set(struct baselines *baselines, const char *name);
/* Copies id, name and time of a baseline to *out. Returns false if the baseline was dropped. */
bool baselines_describe(struct baselines *baselines, uint32_t id, struct baseline *out);
/* Lists the named baselines, oldest first. Returns their number. */
size_t baselines_list(struct baselines *baselines, struct baseline out[BASELINES_NAMED]);

/* Returns the readings of a baseline, valid until baselines_give(); NULL if the baseline was dropped. */
const struct snapshot *baselines_take(struct baselines *baselines, uint32_t id);
/* Ends the use of a snapshot from baselines_take() and sets *snapshot to NULL. *snapshot may be NULL. */
void baselines_give(struct baselines *baselines, const struct snapshot **snapshot);

#endif
