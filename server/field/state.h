/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The field of one asset for one set of parameters: its scalars, and the readings that they show. Thread: one at a time. */
#ifndef FIELD_STATE_H
#define FIELD_STATE_H
#include "base/workers.h"
#include "field/scalars.h"
#include "field/weights.h"
#include "value/snapshot.h"

struct update; /* update.h */

struct state_input {           /* what one sensor says, as the sums take it */
    double value;              /* engineering units; for `paper` 0..1 */
    uint8_t usable, uncertain; /* usable: enum sensor_use */
};

struct field_state {
    struct field_params params;
    struct field_layout *layout;
    struct weights *weights; /* counted in weights->users */
    struct scalars scalars;  /* scalars.version 0: nothing computed yet */
    struct scalar *at;
    double *sums;                    /* by vertex: numerator; NULL: few sensors, always summed anew */
    size_t room;                     /* for so many of the first vertices in these two */
    double error_limit; /* vertices with a larger weights->errors are marked uncertain; 0 at first */
    unsigned errors_version; /* of weights->errors, as they are shown */
    double error_scale; /* times weights->errors: the largest error drawn */
    unsigned added;                  /* updates since they were made anew */
    struct state_input *now, *shown; /* by sensor of the layout: asked for, and in the scalars */
    uint8_t *usable;                 /* by sensor of the layout, of `now` */
    struct state_list {              /* room for weights_terms: of all members, and of those that changed */
        uint32_t *members;
        double *factors;
        uint8_t *marked;
    } lists[2];
    struct update *update; /* under way; NULL: none */
    size_t wanted;         /* the most vertices asked for since the last update */
    uint64_t used;
    struct field_state *next;
};

/* Creates the state, never NULL, without room for vertices yet (state_grow). Copies params; the layout must outlive it. The caller
   destroys it. */
struct field_state *state_create(int asset, struct field_layout *layout, const struct field_params *params);
/* Frees the state. &NULL is fine; leaves NULL. */
void state_destroy(struct field_state **state);
/* Returns the bytes that the state takes. */
size_t state_bytes(const struct field_state *state);
/* Returns by how much state_bytes() would grow with room for the first `count` vertices. */
size_t state_more_bytes(const struct field_state *state, size_t count);
/* Makes room for the first `count` vertices; a far asset needs few of them. Returns false if out of memory, with nothing changed. */
bool state_grow(struct field_state *state, size_t count);

/* Reads the snapshot into state->now, state->usable and the ages. baseline: what a difference is from; NULL: not known. */
void state_read(struct field_state *state, const struct snapshot *snapshot, const struct snapshot *baseline);
/* By a prepared interpolation: gives lost sensors of state->now the values that follow from the others. The weights must be of now. */
void state_fill(struct field_state *state);
/* Returns whether the state's weights were made for other usable sensors than those of now. */
bool state_needs_weights(const struct field_state *state);
/* Returns whether the scalars show something else than state->now. */
bool state_is_behind(const struct field_state *state);
/* For SHOW_DISTANCE, in place of all the above: fills the scalars with the distances from one sensor of the layout, once. */
void state_measure(struct field_state *state, size_t sensor, uint64_t *versions);

#endif
