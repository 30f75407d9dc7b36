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
    struct field_layout **layouts;          /* [asset][group]; NULL: not looked for, or none */
    struct field_state **states;            /* by asset: a list */
    struct weights *weights[FIELD_BUCKETS]; /* all of them, by hash of the key */
    struct baselines *baselines;            /* NULL: none */
    struct trials *trials;                  /* NULL: none */
    struct trial_layout {                   /* layouts with places that are tried out */
        const struct trial *trial;          /* held */
        int asset, group;
        struct field_layout *layout; /* NULL: no sensor is left there */
        struct trial_layout *next;
    } * tried;
    size_t bytes, bound;
    uint64_t tick; /* counts calls: what was used last */
    uint64_t versions;
};

/* Returns the layout of the sensors of params' group on the asset, made if needed; NULL if there are none. params must have been through
   field_params_of(). */
struct field_layout *field_layout(struct field *field, int asset, const struct field_params *params);
/* Returns the layout with the trial's positions. */
struct field_layout *field_trial_layout(struct field *field, int asset, const struct field_params *params);
/* Frees all trial layouts. */
void field_trials_finish(struct field *field);
/* Returns the state for these parameters, found or created, but not brought up to date. NULL if the asset has no sensor of the group, or
   out of memory. */
struct field_state *field_state(struct field *field, int asset, const struct field_params *params);

/* Reads the snapshot into the state and begins the update that it needs. Returns false if out of memory; the state is gone then. */
bool field_begin_update(struct field *field, struct field_state *state, const struct snapshot *snapshot, size_t count);

/* --- the cache (field_cache.c) --- */

/* Returns the list of weights with this hash. */
struct weights **field_cache_bucket(struct field *field, uint64_t hash);
/* Drops the state's hold on its weights. */
void field_cache_release_weights(struct field_state *state);
/* Takes *link out of its list and destroys it. */
void field_cache_remove_state(struct field *field, struct field_state **link);
/* Drops what was last used before tick `before`, but no state of the parameters `keep`, until `need` more bytes fit under the limit: the
   oldest first, an eighth of the time at once, so that they are seldom searched for. Returns false if they do not fit. */
bool field_cache_make_room(struct field *field, size_t need, const struct field_params *keep, uint64_t before);
/* Begins caching the columns of weights that are summed for the second time or later; previous: the tick of their last use. */
void field_cache_keep_columns(struct field *field, struct weights *weights, const struct field_params *params, uint64_t previous);
/* Drops every state and weights object that was made from this trial's layout. */
void field_forget_trial_layout(struct field *field, const struct trial_layout *tried);

#endif
