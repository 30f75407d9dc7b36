/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Brings a state's sums and scalars from the shown readings to the present ones, in as many steps as the caller likes; the readings are
   those at the beginning. Thread: one at a time (work is spread over `workers`). */
#ifndef FIELD_UPDATE_H
#define FIELD_UPDATE_H
#include "field/state.h"

/* Begins an update of at least the first `count` vertices. Until the update ends, state->now must not change and the scalars must not be
   read. */
void update_begin(struct field_state *state, size_t count);
/* Does about `work` nanoseconds (of one core) of the update, and at least one block. Returns true once it is done; state->update is NULL
   then. */
bool update_go_on(struct field_state *state, struct workers *workers, double work, uint64_t *versions);
/* Returns whether the update is small and only reads its weights, so that update_run() may run in parallel with others. */
bool update_is_light(const struct field_state *state);
/* Does the whole update on the calling thread, after update_begin(), if update_is_light() returned true. update_end() must follow. Thread:
   any, in parallel with updates of other states. */
void update_run(struct field_state *state);
/* Completes the update after update_run(). Thread: the one that owns the field. */
void update_end(struct field_state *state, uint64_t *versions);
/* Returns whether the readings of state->now differ by no more than the range that preparation assumed. */
bool update_is_in_range(const struct field_state *state);
/* Abandons the update in progress, if any. */
void update_forget(struct field_state *state);

/* Writes the rule that turns sums into values; inputs: by sensor of the layout. */
void update_rule(const struct field_state *state, const struct state_input *inputs, struct kernel_value *rule);
/* Sets all members of *at except its value, for a prepared vertex of `weights`, which must be for the state's parameters and sensors.
   total: the weights' sum; marked: that of Uncertain sensors, 0: there are none. */
void update_flags(const struct field_state *state, const struct weights *weights, size_t vertex, double total, double marked,
                  struct scalar *at);
/* Returns the smallest hot spot that a sensor at a distance of near_m shows: a hot spot of size s has the shape exp(-D^2 / 2 s^2) around
   its centre, so that a sensor at distance D reads only that part of its height. */
float update_blind(const struct plant_group *group, float near_m);

#endif
