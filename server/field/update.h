/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Brings sums and scalars of a state from what is shown to what sensors say now, in as many pieces as are asked for; the readings are
   those of its beginning. Thread: one at a time (it spreads its work over `workers`). */
#ifndef FIELD_UPDATE_H
#define FIELD_UPDATE_H
#include "field/state.h"

/* The first `count` vertices at least. state->now must not change, and the scalars must not be read, until it is done. */
void update_begin(struct state *state, size_t count);
/* Does so much of it (about nanoseconds of one core), and a little at least. True: done, and state->update is NULL. */
bool update_go_on(struct state *state, struct workers *workers, double work, uint64_t *versions);
/* The same on one core, for one that is light: all of it, by any thread, beside others; then what belongs to the field's thread. Light:
   little to do, and it only reads its weights. */
bool update_is_light(const struct state *state);
void update_run(struct state *state);
void update_end(struct state *state, uint64_t *versions);
void update_forget(struct state *state); /* none under way is fine */

#endif
