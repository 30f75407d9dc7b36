/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the fields (scalars) of assets on request: finds or creates an asset's cached state and weights, and updates the state to new
   readings. */
#include "field/field.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "field/drawn_error.h"
#include "field/field_impl.h"
#include "field/update.h"
#include "plant/influence.h"

struct field *field_create(struct workers *workers, const struct scene *scene)
{
    struct field *field = mem_new(sizeof(*field));
    field->workers = workers;
    field->scene = scene;
    field->bound = FIELD_DEFAULT_BYTES;
    field->layouts = mem_array(scene->asset_count * scene->plant->group_count, sizeof(struct field_layout *));
    field->states = mem_array(scene->asset_count, sizeof(*field->states));
    return field;
}

const struct scene *field_scene(const struct field *field)
{
    return field->scene;
}

struct workers *field_workers(const struct field *field)
{
    return field->workers;
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

/* --- finding or creating states and weights ----------------------------------------------------------------------------- */

static float radius_of(const struct field *field, struct field_layout *layout, const struct field_params *params)
{
    if (params->interpolation != INTERPOLATION_PAPER)
        return 1;
    return params->radius_m > 0 ? (float)params->radius_m : layout_largest(layout, params->distance, field->workers);
}

static bool weights_take(struct field *field, struct field_state *state)
{
    float radius_m = radius_of(field, state->layout, &state->params);
    struct weights_key key;
    weights_key_init(&key, state->layout, &state->params, radius_m, state->usable);
    struct weights **bucket = field_cache_bucket(field, key.hash), *weights = *bucket;
    while (weights && !weights_key_equal(&weights->key, &key))
        weights = weights->next;
    field_cache_release_weights(state);
    if (!weights) {
        field_cache_make_room(field, weights_bytes(state->layout), &state->params, field->tick);
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

struct field_state *field_state(struct field *field, int asset, const struct field_params *params)
{
    struct field_state *state = field->states[asset];
    while (state && !field_params_equal(&state->params, params))
        state = state->next;
    if (state)
        return state;
    struct field_layout *layout = field_layout(field, asset, params);
    if (!layout)
        return NULL;
    state = state_create(asset, layout, params);
    field_cache_make_room(field, state_bytes(state), params, field->tick);
    state->next = field->states[asset];
    field->states[asset] = state;
    field->bytes += state_bytes(state);
    return state;
}

static void forget_state(struct field *field, struct field_state *state)
{
    struct field_state **link = &field->states[state->scalars.asset];
    while (*link != state)
        link = &(*link)->next;
    field_cache_remove_state(field, link);
}

/* Allocates memory for `count` vertices of the state (computed field), and makes room for it in the cache. Returns false when
   out of memory; the state is then freed. */
static bool grow_state(struct field *field, struct field_state *state, size_t count)
{
    size_t more = state_more_bytes(state, count);
    if (more == 0)
        return true;
    field_cache_make_room(field, more, &state->params, field->tick);
    if (!state_grow(state, count)) {
        forget_state(field, state);
        return false;
    }
    field->bytes += more;
    return true;
}

/* Returns the index of the tag's sensor; -1: it is not on the asset, or its position is unknown. */
static int find_sensor(const struct field_layout *layout, int tag)
{
    for (size_t i = 0; layout && !layout->assumed && i < layout->sensor_count; i++)
        if (layout->sensors[i].tag == tag)
            return (int)i;
    return -1;
}

/* Marks the vertices of triangles on which distances along the surface from one sensor are drawn more than a colour step
   off. */
static void mark_distances(struct field *field, struct field_state *state, size_t sensor)
{
    struct field_params params = state->params;
    struct drawn_near near = { .largest_m = 0 };
    if (params.distance == DISTANCE_EUCLIDEAN)
        return;
    params.show = SHOW_VALUE;
    params.interpolation = INTERPOLATION_PAPER; /* the distance from a sensor of strength 0 is shown too */
    params.reach_m = INFINITY;
    memset(state->usable, SENSOR_ASIDE, state->layout->sensor_count);
    state->usable[sensor] = SENSOR_USED;
    uint8_t *marks = mem_try_array(state->scalars.count, 1);
    struct weights *weights = weights_create(state->layout, &params, 1, state->usable, &(struct weights_key){ 0 });
    for (size_t v = 0; v < state->scalars.count; v++)
        near.largest_m = fmaxf(near.largest_m, state->at[v].value);
    const bool is_known = weights && weights->member_count == 1 && marks;
    if (is_known && near.largest_m > 0)
        drawn_error_mark(weights, &params, state->usable, &near, marks, field->workers);
    for (size_t v = 0; v < state->scalars.count; v++)
        state->at[v].uncertain = !is_known || marks[v] ? 255 : 0;
    weights_destroy(&weights);
    mem_free(marks);
}

/* Finds the vertices of triangles on which SHOW_BLIND is drawn with a larger error than drawn_error_mark() accepts, unless they are
   known. */
static void mark_blind(struct field *field, struct field_state *state)
{
    struct weights *weights = state->weights;
    if (weights->blind_marks || !weights_interpolates_blind(weights))
        return;
    weights->blind_marks = mem_try_array(state->layout->vertex_count, 1);
    if (weights->blind_marks)
        drawn_error_mark(weights, &state->params, state->usable, &(struct drawn_near){ .group = state->layout->group },
                         weights->blind_marks, field->workers);
}

static const struct scalars *distance_scalars(struct field *field, int asset, const struct field_params *params,
                                              const struct snapshot *snapshot)
{
    int sensor = find_sensor(field_layout(field, asset, params), params->sensor);
    struct field_state *state = sensor < 0 ? NULL : field_state(field, asset, params);
    if (!state)
        return NULL;
    state->used = field->tick;
    state_read(state, snapshot, NULL);
    state->scalars.oldest_age_ns = INT64_MAX;
    if (!grow_state(field, state, state->scalars.count))
        return NULL;
    if (state->scalars.version == 0) {
        state_measure(state, (size_t)sensor, &field->versions);
        mark_distances(field, state, (size_t)sensor);
    }
    return &state->scalars;
}

bool field_covers(struct field *field, int asset, const struct field_params *params)
{
    const struct field_layout *layout = field_layout(field, asset, params);
    /* the views of uncertainty and of blindness (SHOW_BLIND: undetectable hot spots) depend on the real sensor positions, so
       they show nothing if positions are assumed */
    if (field_params_cover(params) && layout && layout->assumed)
        return false;
    return params->show == SHOW_DISTANCE ? find_sensor(layout, params->sensor) >= 0 : layout != NULL;
}

bool field_is_assumed(struct field *field, int asset, const struct field_params *params)
{
    struct field_params room;
    const struct field_layout *layout = field_layout(field, asset, field_params_of(field, asset, params, &room));
    return layout && layout->assumed;
}

static void read_inputs(const struct field *field, struct field_state *state, const struct snapshot *snapshot)
{
    bool difference = state->params.show == SHOW_DIFFERENCE && field->baselines;
    const struct snapshot *baseline = difference ? baselines_take(field->baselines, state->params.baseline) : NULL;
    state_read(state, snapshot, baseline);
    if (baseline)
        baselines_give(field->baselines, &baseline);
}

bool field_begin_update(struct field *field, struct field_state *state, const struct snapshot *snapshot, size_t count)
{
    read_inputs(field, state, snapshot);
    if (state_needs_weights(state) && !weights_take(field, state)) {
        forget_state(field, state);
        return false;
    }
    state_fill(state);
    struct weights *weights = state->weights;
    if (state->params.show == SHOW_BLIND)
        mark_blind(field, state);
    if (!field_params_cover(&state->params))
        drawn_error_measure(weights, &state->params, state->usable, count, update_is_in_range(state), field->workers);
    uint64_t previous = weights->used;
    weights->used = field->tick;
    if (!state_is_behind(state) && state->scalars.ready >= count)
        return true;
    if (!grow_state(field, state, state->wanted > count ? state->wanted : count))
        return false;
    field_cache_keep_columns(field, weights, &state->params, previous);
    weights->sums++;
    update_begin(state, count);
    return true;
}

/* Updates the field of one asset for about `work` nanoseconds. Returns NULL if the asset has no field to show, or when out of
   memory. *done: true if the field is up to date, false if more calls are needed. */
static const struct scalars *advance(struct field *field, int asset, const struct field_params *params, const struct snapshot *snapshot,
                                     size_t count, double work, bool *done)
{
    struct field_params room;
    params = field_params_of(field, asset, params, &room);
    field->tick++;
    *done = true;
    if (params->show == SHOW_DISTANCE)
        return distance_scalars(field, asset, params, snapshot);
    if (!field_covers(field, asset, params))
        return NULL;
    struct field_state *state = field_state(field, asset, params);
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

bool field_advance(struct field *field, int asset, const struct field_params *params, const struct snapshot *snapshot, size_t count,
                   double work)
{
    bool done;
    advance(field, asset, params, snapshot, count, work, &done);
    return done;
}
