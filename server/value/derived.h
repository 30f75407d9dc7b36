/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes derived tags from the readings of other tags, several times a second, and writes the results to the store like a source. A
   result has the age of its newest input and the worst quality of its inputs. */
#ifndef VALUE_DERIVED_H
#define VALUE_DERIVED_H
#include "value/source.h"

/* the results of derived tags that were written last, so that only changes are written; use it in one thread only */
struct derived_state;

/* Starts the thread that computes derived tags. Returns it as a source, which plant->sources does not contain; end it with
   source_stop(). NULL if the thread could not be started (logged). */
struct source *derived_start(struct log *log, const struct plant *plant, struct store *store);

/* derived_create(), derived_destroy() and derived_compute() compute derived tags without their own thread and clock: each call
   of derived_compute() computes all derived tags once. */
struct derived_state *derived_create(const struct plant *plant);
void derived_destroy(struct derived_state **state); /* Frees the state and sets *state to NULL. *state may be NULL. */
void derived_compute(struct derived_state *state, struct store *store, int64_t now_mono_ns, int64_t now_utc_ns);

#endif
