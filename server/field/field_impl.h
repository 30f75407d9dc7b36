/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of the field (field*.c). */
#ifndef FIELD_FIELD_IMPL_H
#define FIELD_FIELD_IMPL_H
#include "field/field.h"
#include "field/state.h"

#define FIELD_BUCKETS 256

struct field {
    struct workers *workers;
    const struct scene *scene;
    struct layout **layouts;                /* [asset][group]; NULL: not looked for, or none */
    struct state **states;                  /* by asset: a list */
    struct weights *weights[FIELD_BUCKETS]; /* all of them, by hash of the key */
    struct baselines *baselines;            /* NULL: none */
    struct trials *trials;                  /* NULL: none */
    struct trial_layout {                   /* layouts with places that are tried out */
        const struct trial *trial;          /* held */
        int asset, group;
        struct layout *layout; /* NULL: no sensor is left there */
        struct trial_layout *next;
    } * tried;
    size_t bytes, bound;
    uint64_t tick; /* counts calls: what was used last */
    uint64_t versions;
};

/* Returns the layout of the sensors of params' group on the asset, made if needed; NULL if there are none. params must have been through
   field_params_of(). */
struct layout *field_layout(struct field *field, int asset, const struct field_params *params);
/* Returns the layout with the trial's positions. */
struct layout *field_trial_layout(struct field *field, int asset, const struct field_params *params);
/* Drops every state and weights object that was made from this trial's layout. */
void field_forget_trial_layout(struct field *field, const struct trial_layout *tried);
/* Frees all trial layouts. */
void field_trials_finish(struct field *field);
/* Returns the state for these parameters, found or created, but not brought up to date. NULL if the asset has no sensor of the group, or
   out of memory. */
struct state *field_state(struct field *field, int asset, const struct field_params *params);

/* Reads the snapshot into the state and begins the update that it needs. Returns false if out of memory; the state is gone then. */
bool field_begin_update(struct field *field, struct state *state, const struct snapshot *snapshot, size_t count);

#endif
