/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Updates a state's sums and scalars to new readings. The work can be spread over several calls, which all use the readings
   present when the update began. Call from one thread at a time (work is spread over `workers`). */
#ifndef FIELD_UPDATE_H
#define FIELD_UPDATE_H
#include "field/state.h"

/* Begins an update of the values at the first `count` vertices or more. Until the update ends, state->now must not change, and
   the scalars must not be read. */
void update_begin(struct field_state *state, size_t count);
/* Does about `work` nanoseconds (of one core) of the update, but at least one block. Returns true once it is done;
   state->update is then NULL. */
bool update_go_on(struct field_state *state, struct workers *workers, double work, uint64_t *versions);
/* Returns true if the state's update is short and does not change its weights, so that update_run() may run in parallel with other
   updates. */
bool update_is_light(const struct field_state *state);
/* After update_begin(): runs the whole update on the calling thread, provided update_is_light() returned true. update_end()
   must follow. Call from any thread, in parallel with updates of other states. */
void update_run(struct field_state *state);
/* Completes an update that update_run() has computed on any thread: gives the changed scalars a new version. Call only in the
   thread that owns the field. */
void update_end(struct field_state *state, uint64_t *versions);
/* Returns true if the spread of the readings in state->now is at most the range that plantcast-prep assumed when it subdivided
   triangles. */
bool update_is_in_range(const struct field_state *state);
/* Frees the state's update in progress, if any, without completing it. */
void update_forget(struct field_state *state);

/* Writes the rule by which sums over sensors become field values to *rule. inputs: the sensors' readings, in the order of the
   layout. */
void update_rule(const struct field_state *state, const struct state_input *inputs, struct kernel_value *rule);
/* Sets all members of *at except its value, for a prepared vertex of `weights`, which must match the state's parameters and
   sensors. total: sum of the vertex's weights; marked: sum of the weights of Uncertain sensors, 0 if there are none. */
void update_flags(const struct field_state *state, const struct weights *weights, size_t vertex, double total, double marked,
                  struct scalar *at);
/* Returns by how much the centre of a hot spot must exceed its surroundings, in the unit of the field, for a sensor at distance
   near_m to show it. A hot spot of size s (the group's hot_spot_m) has the shape exp(-D^2 / (2 s^2)) around its centre, so a
   sensor at distance D reads only that fraction of the excess. */
float update_blind(const struct plant_group *group, float near_m);

#endif
