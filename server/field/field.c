/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The fields that someone looks at, each kept once, and the bound on what they take. */
#include "field/field.h"

#include <math.h>

#include "base/mem.h"
#include "field/field_impl.h"
#include "field/update.h"

struct field *field_create(struct workers *workers, const struct scene *scene)
{
    struct field *field = mem_new(sizeof(*field));
    field->workers = workers;
    field->scene = scene;
    field->bound = FIELD_DEFAULT_BYTES;
    field->layouts = mem_array(scene->asset_count * scene->plant->group_count, sizeof(struct layout *));
    field->states = mem_array(scene->asset_count, sizeof(*field->states));
    return field;
}

/* --- the cache ----------------------------------------------------------------------------------------------------------- */

static void columns_drop(struct field *field, struct weights *weights)
{
    field->bytes -= weights_kept_bytes(weights);
    weights_drop_columns(weights);
}

static struct weights **bucket_of(struct field *field, uint64_t hash)
{
    return &field->weights[hash % FIELD_BUCKETS];
}

/* *link is taken out of its list. */
static void weights_remove(struct field *field, struct weights **link)
{
    struct weights *weights = *link;
    *link = weights->next;
    if (weights->columns)
        columns_drop(field, weights);
    field->bytes -= weights_bytes(weights->layout);
    weights_destroy(&weights);
}

static void weights_release(struct state *state)
{
    if (state->weights)
        state->weights->users--;
    state->weights = NULL;
}

static void state_remove(struct field *field, struct state **link)
{
    struct state *state = *link;
    *link = state->next;
    weights_release(state);
    field->bytes -= state_bytes(state);
    update_forget(state);
    state_destroy(&state);
}

struct workers *field_workers(const struct field *field)
{
    return field->workers;
}

void field_clear_cache(struct field *field)
{
    for (size_t i = 0; i < field->scene->asset_count; i++)
        while (field->states[i])
            state_remove(field, &field->states[i]);
    for (size_t i = 0; i < FIELD_BUCKETS; i++)
        while (field->weights[i])
            weights_remove(field, &field->weights[i]);
}

void field_destroy(struct field **field_ptr)
{
    struct field *field = *field_ptr;
    if (!field)
        return;
    field_clear_cache(field);
    for (size_t i = 0; i < field->scene->asset_count * field->scene->plant->group_count; i++)
        layout_destroy(&field->layouts[i]);
    field_trials_finish(field);
    mem_free(field->layouts);
    mem_free(field->states);
    mem_free(field);
    *field_ptr = NULL;
}

void field_set_baselines(struct field *field, struct baselines *baselines)
{
    field->baselines = baselines;
}

bool field_baseline(const struct field *field, const struct field_params *params, struct baseline *out)
{
    return params->show == SHOW_DIFFERENCE && field->baselines && baselines_describe(field->baselines, params->baseline, out);
}

void field_set_cache_limit(struct field *field, size_t bytes)
{
    field->bound = bytes;
}

size_t field_bytes(const struct field *field)
{
    return field->bytes;
}

static bool weights_may_go(const struct weights *weights)
{
    return weights->users == 0 || weights->columns;
}

/* The least tick of use of all that may go; UINT64_MAX: nothing may. */
static uint64_t oldest_use(const struct field *field, const struct field_params *keep)
{
    uint64_t oldest = UINT64_MAX;
    for (size_t i = 0; i < field->scene->asset_count; i++)
        for (const struct state *state = field->states[i]; state; state = state->next)
            if (state->used < oldest && !field_params_equal(&state->params, keep))
                oldest = state->used;
    for (size_t i = 0; i < FIELD_BUCKETS; i++)
        for (const struct weights *weights = field->weights[i]; weights; weights = weights->next)
            if (weights->used < oldest && weights_may_go(weights))
                oldest = weights->used;
    return oldest;
}

static void drop_used_before(struct field *field, const struct field_params *keep, uint64_t before)
{
    for (size_t i = 0; i < field->scene->asset_count; i++)
        for (struct state **link = &field->states[i]; *link;) {
            if ((*link)->used < before && !field_params_equal(&(*link)->params, keep))
                state_remove(field, link);
            else
                link = &(*link)->next;
        }
    for (size_t i = 0; i < FIELD_BUCKETS; i++)
        for (struct weights **link = &field->weights[i]; *link;) {
            struct weights *weights = *link;
            if (weights->used < before && weights->users == 0) {
                weights_remove(field, link);
                continue;
            }
            if (weights->used < before && weights->columns)
                columns_drop(field, weights);
            link = &weights->next;
        }
}

/* Drops what was last used before tick `before`, but no state of the parameters `keep`, until `need` more bytes fit under the
   bound. The oldest go first, an eighth of the time at once, so that looking for them is seldom. False: they do not fit. */
static bool make_room(struct field *field, size_t need, const struct field_params *keep, uint64_t before)
{
    while (field->bytes + need > field->bound) {
        uint64_t oldest = oldest_use(field, keep);
        if (oldest >= before)
            return false;
        uint64_t until = oldest + (field->tick - oldest) / 8 + 1;
        drop_used_before(field, keep, until < before ? until : before);
    }
    return true;
}

/* Columns are worth their memory from the second sum on: while somebody drags a parameter there is none. They only push out what was
   used longer ago than these weights before, or two busy fields would push each other out for ever. Where not all fit, as many as do:
   of the first vertices, which all levels of detail have. */
static void keep_columns(struct field *field, struct weights *weights, const struct field_params *params, uint64_t previous)
{
    size_t bytes = weights_column_bytes(weights), had = weights_kept_bytes(weights);
    if (weights->sums == 0 || had == bytes)
        return;
    if (had == 0)
        make_room(field, bytes < field->bound ? bytes : field->bound, params, previous);
    else if (field->bytes - had + bytes > field->bound) /* there is no more room than there was */
        return;
    else
        columns_drop(field, weights);
    if (field->bytes < field->bound)
        field->bytes += weights_keep(weights, field->bound - field->bytes);
}

/* --- finding what is there, making what is not -------------------------------------------------------------------------- */

struct layout *field_layout(struct field *field, int asset, const struct field_params *params)
{
    struct layout **at = &field->layouts[(size_t)asset * field->scene->plant->group_count + (size_t)params->group];
    if (params->trial)
        return field_trial_layout(field, asset, params);
    if (!*at)
        *at = layout_create(field->scene, asset, params->group, NULL);
    return *at;
}

void field_forget_trial_layout(struct field *field, const struct trial_layout *tried)
{
    for (struct state **link = &field->states[tried->asset]; *link;)
        if ((*link)->layout == tried->layout)
            state_remove(field, link);
        else
            link = &(*link)->next;
    for (size_t i = 0; i < FIELD_BUCKETS; i++)
        for (struct weights **link = &field->weights[i]; *link;)
            if ((*link)->layout == tried->layout)
                weights_remove(field, link);
            else
                link = &(*link)->next;
}

static float radius_of(const struct field *field, struct layout *layout, const struct field_params *params)
{
    if (params->interpolation != INTERPOLATION_PAPER)
        return 1;
    return params->radius_m > 0 ? (float)params->radius_m : layout_largest(layout, params->distance, field->workers);
}

static bool weights_take(struct field *field, struct state *state)
{
    float radius_m = radius_of(field, state->layout, &state->params);
    struct weights_key key;
    weights_key_init(&key, state->layout, &state->params, radius_m, state->usable);
    struct weights **bucket = bucket_of(field, key.hash), *weights = *bucket;
    while (weights && !weights_key_equal(&weights->key, &key))
        weights = weights->next;
    weights_release(state);
    if (!weights) {
        make_room(field, weights_bytes(state->layout), &state->params, field->tick);
        weights = weights_create(state->layout, &state->params, radius_m, state->usable, &key);
        for (size_t i = 0; weights && i < FIELD_BUCKETS; i++)
            for (const struct weights *other = field->weights[i]; other; other = other->next)
                weights_copy_known(weights, other);
        if (weights) {
            weights->next = *bucket;
            *bucket = weights;
            field->bytes += weights_bytes(state->layout);
        }
    }
    weights_key_finish(&key);
    state->weights = weights;
    if (weights)
        weights->users++;
    return weights;
}

struct state *field_state(struct field *field, int asset, const struct field_params *params)
{
    struct state *state = field->states[asset];
    while (state && !field_params_equal(&state->params, params))
        state = state->next;
    if (state)
        return state;
    struct layout *layout = field_layout(field, asset, params);
    if (!layout)
        return NULL;
    state = state_create(asset, layout, params);
    make_room(field, state_bytes(state), params, field->tick);
    state->next = field->states[asset];
    field->states[asset] = state;
    field->bytes += state_bytes(state);
    return state;
}

static void forget_state(struct field *field, struct state *state)
{
    struct state **link = &field->states[state->scalars.asset];
    while (*link != state)
        link = &(*link)->next;
    state_remove(field, link);
}

/* False: out of memory, the state is gone. */
static bool grow_state(struct field *field, struct state *state, size_t count)
{
    size_t more = state_more_bytes(state, count);
    if (more == 0)
        return true;
    make_room(field, more, &state->params, field->tick);
    if (!state_grow(state, count)) {
        forget_state(field, state);
        return false;
    }
    field->bytes += more;
    return true;
}

/* -1: it does not stand on the asset. */
static int find_sensor(const struct layout *layout, int tag)
{
    for (size_t i = 0; layout && i < layout->sensor_count; i++)
        if (layout->sensors[i].tag == tag)
            return (int)i;
    return -1;
}

static const struct scalars *distance_scalars(struct field *field, int asset, const struct field_params *params,
                                              const struct snapshot *snapshot)
{
    int sensor = find_sensor(field_layout(field, asset, params), params->sensor);
    struct state *state = sensor < 0 ? NULL : field_state(field, asset, params);
    if (!state)
        return NULL;
    state->used = field->tick;
    state_read(state, snapshot, NULL);
    state->scalars.oldest_age_ns = INT64_MAX;
    if (!grow_state(field, state, state->scalars.count))
        return NULL;
    if (state->scalars.version == 0)
        state_measure(state, (size_t)sensor, &field->versions);
    return &state->scalars;
}

bool field_covers(struct field *field, int asset, const struct field_params *params)
{
    const struct layout *layout = field_layout(field, asset, params);
    return params->show == SHOW_DISTANCE ? find_sensor(layout, params->sensor) >= 0 : layout != NULL;
}

static void read_inputs(const struct field *field, struct state *state, const struct snapshot *snapshot)
{
    bool difference = state->params.show == SHOW_DIFFERENCE && field->baselines;
    const struct snapshot *baseline = difference ? baselines_take(field->baselines, state->params.baseline) : NULL;
    state_read(state, snapshot, baseline);
    if (baseline)
        baselines_give(field->baselines, &baseline);
}

bool field_begin_update(struct field *field, struct state *state, const struct snapshot *snapshot, size_t count)
{
    read_inputs(field, state, snapshot);
    if (state_needs_weights(state) && !weights_take(field, state)) {
        forget_state(field, state);
        return false;
    }
    struct weights *weights = state->weights;
    uint64_t previous = weights->used;
    weights->used = field->tick;
    if (!state_is_behind(state) && state->scalars.ready >= count)
        return true;
    if (!grow_state(field, state, state->wanted > count ? state->wanted : count))
        return false;
    keep_columns(field, weights, &state->params, previous);
    weights->sums++;
    update_begin(state, count);
    return true;
}

/* NULL: nothing to show, or out of memory. *done: up to date; else some of the work was done. */
static const struct scalars *advance(struct field *field, int asset, const struct field_params *params, const struct snapshot *snapshot,
                                     size_t count, double work, bool *done)
{
    struct field_params room;
    params = field_params_of(field, asset, params, &room);
    field->tick++;
    *done = true;
    if (params->show == SHOW_DISTANCE)
        return distance_scalars(field, asset, params, snapshot);
    struct state *state = field_state(field, asset, params);
    if (!state)
        return NULL;
    state->used = field->tick;
    if (state->update && !update_go_on(state, field->workers, work, &field->versions)) {
        *done = false;
        return &state->scalars;
    }
    state->wanted = state->wanted > count ? state->wanted : count;
    if (!field_begin_update(field, state, snapshot, count))
        return NULL;
    *done = !state->update || update_go_on(state, field->workers, work, &field->versions);
    return &state->scalars;
}

const struct scalars *field_scalars_of(struct field *field, int asset, const struct field_params *params, const struct snapshot *snapshot,
                                       size_t count)
{
    bool done;
    const struct scalars *scalars;
    do
        scalars = advance(field, asset, params, snapshot, count, (double)INFINITY, &done);
    while (!done);
    return scalars;
}

const struct scalars *field_scalars(struct field *field, int asset, const struct field_params *params, const struct snapshot *snapshot)
{
    return field_scalars_of(field, asset, params, snapshot, field->scene->assets[asset].file->view.header->vertex_count);
}

bool field_advance(struct field *field, int asset, const struct field_params *params, const struct snapshot *snapshot, size_t count,
                   double work)
{
    bool done;
    advance(field, asset, params, snapshot, count, work, &done);
    return done;
}
