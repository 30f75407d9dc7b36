/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the derived tags of a plant from the readings of others, some times a second, and writes them to the store like a source.
   A value is as old as the newest of what it was computed from, and of the worst quality among that. */
#ifndef VALUE_DERIVED_H
#define VALUE_DERIVED_H
#include "value/source.h"

struct derived_state; /* what was written last */

/* A source that is none of plant->sources: source_stop ends it. NULL: no thread, logged. */
struct source *derived_start(struct log *log, const struct plant *plant, struct store *store);

/* One round, without a thread or a clock. */
struct derived_state *derived_create(const struct plant *plant);
void derived_destroy(struct derived_state **state); /* &NULL is fine; leaves NULL */
void derived_compute(struct derived_state *state, struct store *store, int64_t now_mono_ns, int64_t now_utc_ns);

#endif
