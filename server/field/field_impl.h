/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of struct field, which computes and caches the values interpolated between sensors, and functions that the field*.c
   files share. Private to them. */
#ifndef FIELD_FIELD_IMPL_H
#define FIELD_FIELD_IMPL_H
#include "field/field.h"
#include "field/state.h"

#define FIELD_BUCKETS 256

struct field {
    struct workers *workers;
    const struct scene *scene;
    /* [asset][group]: layout (sensors and their distances) of the group on the asset; NULL: not created yet, or the asset has
       no sensor of the group */
    struct field_layout **layouts;
    struct field_state **states;            /* [asset]: linked list of the asset's cached states (computed fields) */
    struct weights *weights[FIELD_BUCKETS]; /* hash table of all cached weights, by their key */
    struct baselines *baselines;            /* NULL: none */
    struct trials *trials;                  /* NULL: none */
    struct trial_layout {                   /* layouts with trial positions */
        const struct trial *trial;          /* reference to the trial */
        int asset, group;
        /* layout (sensors and their distances) with the sensors at the positions that a user tries out; NULL: the asset then
           has no sensor of the group */
        struct field_layout *layout;
        struct trial_layout *next;
    } * tried;
    size_t bytes, bound;
    uint64_t tick; /* number of calls so far: the time ("tick") by which the least recently used cache entries are found */
    uint64_t versions;
};

/* Returns the layout (positions and distances) of the sensors of group params->group on the asset; creates it if needed. NULL:
   there are no such sensors. params must come from field_params_of(). */
struct field_layout *field_layout(struct field *field, int asset, const struct field_params *params);
/* Frees all trial layouts. */
void field_trials_finish(struct field *field);
/* Returns the asset's state (computed field) for these parameters, from the cache or newly created, but does not update it.
   NULL if the asset has no sensor of the group, or when out of memory. */
struct field_state *field_state(struct field *field, int asset, const struct field_params *params);

/* Reads the snapshot's readings into the state (computed field of an asset) and begins an update if one is necessary. Returns
   false when out of memory; the state is then freed. */
bool field_begin_update(struct field *field, struct field_state *state, const struct snapshot *snapshot, size_t count);

/* --- the cache (field_cache.c) --- */

/* Returns the bucket (linked list) of the hash table of cached weights to which this hash belongs. */
struct weights **field_cache_bucket(struct field *field, uint64_t hash);
/* Drops the reference to weights that the state (computed field) holds, which can then be evicted from the cache. */
void field_cache_release_weights(struct field_state *state);
/* Removes the state (computed field) that *link points to from its asset's list of cached states and destroys it. */
void field_cache_remove_state(struct field *field, struct field_state **link);
/* Evicts entries last used before tick `before`, except states with the parameters `keep`, until `need` more bytes fit the
   limit. Evicts the oldest entries first; each search covers an eighth of the time span of last uses, so that searches are
   rare. Returns false if the bytes do not fit. */
bool field_cache_make_room(struct field *field, size_t need, const struct field_params *keep, uint64_t before);
/* Starts caching the columns of these weights (each sensor's weights at all vertices) if the weights were already used in an
   earlier sum. previous: tick of the use of the weights before the current one; to make room, only cache entries last used
   before that tick are evicted. */
void field_cache_keep_columns(struct field *field, struct weights *weights, const struct field_params *params, uint64_t previous);
/* Frees every state (computed field) and weights object made from this layout, whose sensors are at positions that a user tries
   out. */
void field_forget_trial_layout(struct field *field, const struct trial_layout *tried);

#endif
