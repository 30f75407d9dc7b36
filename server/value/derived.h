/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes derived tags from the readings of other tags, several times a second, and writes them to the store like a source. A result is as
   old as the newest of its inputs and has the worst quality among them. */
#ifndef VALUE_DERIVED_H
#define VALUE_DERIVED_H
#include "value/source.h"

struct derived_state; /* the results that were written last */

/* Starts the thread that computes derived tags. Returns it as a source, to be ended by source_stop(), though it is none of plant->sources;
   NULL if there is no thread (logged). */
struct source *derived_start(struct log *log, const struct plant *plant, struct store *store);

/* The computation without a thread and a clock: derived_compute() does one round. */
struct derived_state *derived_create(const struct plant *plant);
void derived_destroy(struct derived_state **state); /* &NULL is fine; leaves NULL */
void derived_compute(struct derived_state *state, struct store *store, int64_t now_mono_ns, int64_t now_utc_ns);

#endif
