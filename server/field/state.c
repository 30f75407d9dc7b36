/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads each sensor's contribution to the field from a snapshot, and decides whether the computed scalars are out of date. */
#include "field/state.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "field/limits.h"
#include "value/quality.h"

#define FLAG 255
/* A lost sensor (one without a usable reading) gets a value computed from the others, which is flagged as uncertain if Uncertain
   sensors contribute more than this fraction. */
#define FILLED_DOUBT 0.1
#define READING_LIMIT 1e30 /* readings are limited to this magnitude, because larger ones would overflow sums of floats */

struct field_state *state_create(int asset, struct field_layout *layout, const struct field_params *params)
{
    struct field_state *state = mem_new(sizeof(*state));
    state->params = *params;
    state->layout = layout;
    state->scalars = (struct scalars){ .asset = asset, .count = layout->vertex_count };
    state->now = mem_array(layout->sensor_count, sizeof(*state->now));
    state->shown = mem_array(layout->sensor_count, sizeof(*state->shown));
    state->usable = mem_array(layout->sensor_count, 1);
    for (int i = 0; i < 2; i++) {
        state->lists[i].members = mem_array(layout->sensor_count, sizeof(*state->lists[i].members));
        state->lists[i].factors = mem_array(layout->sensor_count, sizeof(*state->lists[i].factors));
        state->lists[i].marked = mem_array(layout->sensor_count, 1);
    }
    return state;
}

void state_destroy(struct field_state **state_ptr)
{
    struct field_state *state = *state_ptr;
    if (!state)
        return;
    mem_free(state->at);
    mem_free(state->sums);
    mem_free(state->now);
    mem_free(state->shown);
    mem_free(state->usable);
    for (int i = 0; i < 2; i++) {
        mem_free(state->lists[i].members);
        mem_free(state->lists[i].factors);
        mem_free(state->lists[i].marked);
    }
    mem_free(state);
    *state_ptr = NULL;
}

/* Returns true if the state stores its sums over sensors between updates. With few sensors it does not, because summing again
   is as fast as reading and writing the sums. */
static bool keeps_sums(const struct field_state *state)
{
    return state->layout->sensor_count > KERNEL_COLUMNS;
}

static size_t each_vertex(const struct field_state *state)
{
    return sizeof(*state->at) + (keeps_sums(state) ? sizeof(*state->sums) : 0);
}

size_t state_bytes(const struct field_state *state)
{
    size_t each_sensor = 2 * sizeof(struct state_input) + 1 + 2 * (sizeof(uint32_t) + sizeof(double) + 1);
    return sizeof(struct field_state) + state->room * each_vertex(state) + state->layout->sensor_count * each_sensor;
}

/* Returns the number of vertices for which to allocate memory: `count` rounded up to whole blocks of KERNEL_BLOCK, but at most
   the number of vertices of the asset. */
static size_t room_for(const struct field_state *state, size_t count)
{
    size_t whole = (count + KERNEL_BLOCK - 1) / KERNEL_BLOCK * KERNEL_BLOCK;
    return whole < state->layout->vertex_count ? whole : state->layout->vertex_count;
}

size_t state_more_bytes(const struct field_state *state, size_t count)
{
    size_t room = room_for(state, count);
    return room > state->room ? (room - state->room) * each_vertex(state) : 0;
}

bool state_grow(struct field_state *state, size_t count)
{
    size_t room = room_for(state, count);
    if (room <= state->room)
        return true;
    struct scalar *at = mem_try_array(room, sizeof(*at));
    double *sums = keeps_sums(state) ? mem_try_array(room, sizeof(*sums)) : NULL;
    if (!at || (keeps_sums(state) && !sums)) {
        mem_free(at);
        mem_free(sums);
        return false;
    }
    if (state->room > 0)
        memcpy(at, state->at, state->room * sizeof(*at));
    if (state->room > 0 && sums)
        memcpy(sums, state->sums, state->room * sizeof(*sums));
    mem_free(state->at);
    mem_free(state->sums);
    state->at = at;
    state->sums = sums;
    state->scalars.at = at;
    state->room = room;
    return true;
}

static double limited(double x, double low, double high)
{
    return x < low ? low : x > high ? high : x;
}

static double value_of(const struct field_state *state, const struct plant_tag *tag, double reading)
{
    const struct plant_group *group = state->layout->group;
    if (state->params.show == SHOW_OPERATOR)
        return (float)limit_place(group, tag, reading);
    if (state->params.interpolation == INTERPOLATION_FIN)
        reading -= state->params.show == SHOW_DIFFERENCE ? 0 : group->ambient;
    if (state->params.interpolation == INTERPOLATION_PAPER)
        return (float)limited((reading - group->min) / (group->max - group->min), 0, 1);
    return (float)limited(reading, -READING_LIMIT, READING_LIMIT);
}

static struct state_input input_of(const struct field_state *state, const struct plant_tag *tag, const struct reading *reading)
{
    bool good = !quality_is_bad(reading->quality) && isfinite(reading->value);
    /* coverage quantities (SHOW_UNCERTAINTY, SHOW_BLIND) depend only on whether a sensor is good, so its value stays 0 */
    if (field_params_cover(&state->params))
        return (struct state_input){ .usable = good ? SENSOR_USED : SENSOR_LOST };
    double value = good ? value_of(state, tag, reading->value) : 0;
    return (struct state_input){
        .value = isfinite(value) ? value : 0,
        .usable = !good             ? SENSOR_LOST
                  : isfinite(value) ? SENSOR_USED
                                    : SENSOR_NO_LIMITS,
        .uncertain = good && quality_is_uncertain(reading->quality),
    };
}

/* Subtracts the baseline's input `then` from the current input `now`. A sensor contributes only if it is usable in both;
   otherwise a sensor that appeared or failed since would look like a change of the plant. */
static struct state_input less(struct state_input now, struct state_input then)
{
    bool usable = now.usable && then.usable;
    return (struct state_input){
        .value = usable ? now.value - then.value : 0,
        .usable = usable,
        .uncertain = usable && (now.uncertain || then.uncertain),
    };
}

/* Returns how critical a reading is. With limits: the absolute position between its tag's limits (0: middle, 1: at a limit);
   else the distance from the middle of the group's range, relative to half the range, below 1. */
static double severity_of(const struct plant_group *group, const struct plant_tag *tag, double reading)
{
    double place = limit_place(group, tag, reading), middle = (group->min + group->max) / 2;
    return isfinite(place) ? fabs(place) : fmin(fabs(reading - middle) / (group->max - middle), 0.999);
}

/* If all sensor positions are assumed, selects the sensor with the most critical reading (severity_of) to give the asset's
   value; among equal ones the first. */
static void choose_one(struct field_state *state, const struct snapshot *snapshot)
{
    const struct field_layout *layout = state->layout;
    double most = -1;
    size_t chosen = layout->sensor_count;
    for (size_t i = 0; i < layout->sensor_count; i++) {
        int tag = layout->sensors[i].tag;
        double reading = snapshot->readings[tag].value;
        double severity = state->now[i].usable == SENSOR_USED ? severity_of(layout->group, &layout->tags[tag], reading) : -1;
        if (severity > most) {
            most = severity;
            chosen = i;
        }
    }
    for (size_t i = 0; i < layout->sensor_count && chosen < layout->sensor_count; i++)
        if (i != chosen)
            state->now[i] = (struct state_input){ .usable = SENSOR_ASIDE };
}

void state_read(struct field_state *state, const struct snapshot *snapshot, const struct snapshot *baseline)
{
    int64_t oldest_ns = -1;
    for (size_t i = 0; i < state->layout->sensor_count; i++) {
        int tag = state->layout->sensors[i].tag;
        const struct plant_tag *described = &state->layout->tags[tag];
        const struct reading *reading = &snapshot->readings[tag];
        state->now[i] = input_of(state, described, reading);
        const struct state_input nothing = { 0 };
        if (state->params.show == SHOW_DIFFERENCE)
            state->now[i] = less(state->now[i], baseline ? input_of(state, described, &baseline->readings[tag]) : nothing);
    }
    if (state->layout->assumed)
        choose_one(state, snapshot);
    for (size_t i = 0; i < state->layout->sensor_count; i++) {
        const struct reading *reading = &snapshot->readings[state->layout->sensors[i].tag];
        state->usable[i] = state->now[i].usable;
        if (state->usable[i] && state->usable[i] != SENSOR_ASIDE && reading->age_ns > oldest_ns)
            oldest_ns = reading->age_ns;
    }
    state->scalars.oldest_age_ns = oldest_ns >= 0 ? oldest_ns : INT64_MAX;
}

void state_fill(struct field_state *state)
{
    const struct weights *weights = state->weights;
    if (!weights->fill || field_params_cover(&state->params))
        return;
    double *values = mem_array(state->layout->sensor_count, sizeof(*values));
    double *doubts = mem_array(state->layout->sensor_count, sizeof(*doubts));
    for (size_t i = 0; i < state->layout->sensor_count; i++) {
        values[i] = state->now[i].value;
        doubts[i] = state->now[i].uncertain;
    }
    influence_fill_values(weights->fill, values);
    /* computes which fraction of the value of each lost sensor (one without a usable reading) comes from Uncertain readings */
    influence_fill_values(weights->fill, doubts);
    for (size_t i = 0; i < state->layout->sensor_count; i++)
        if (!weights->takes_part[i]) {
            state->now[i].value = limited(values[i], -READING_LIMIT, READING_LIMIT);
            state->now[i].uncertain = fabs(doubts[i]) > FILLED_DOUBT;
        }
    mem_free(values);
    mem_free(doubts);
}

bool state_needs_weights(const struct field_state *state)
{
    for (size_t i = 0; i < state->layout->sensor_count; i++)
        if (state->now[i].usable != state->shown[i].usable)
            return true;
    return !state->weights;
}

bool state_is_behind(const struct field_state *state)
{
    if (state->scalars.version == 0 || state->errors_version != state->weights->errors_version)
        return true;
    for (size_t i = 0; i < state->layout->sensor_count; i++) {
        const struct state_input *now = &state->now[i], *shown = &state->shown[i];
        if (now->usable != shown->usable || now->uncertain != shown->uncertain || now->value != shown->value)
            return true;
    }
    return false;
}

void state_measure(struct field_state *state, size_t sensor, uint64_t *versions)
{
    struct scalars *scalars = &state->scalars;
    float scratch[KERNEL_BLOCK], most_m = 0;
    for (size_t at = 0, count; at < scalars->count; at += count) {
        count = scalars->count - at < KERNEL_BLOCK ? scalars->count - at : KERNEL_BLOCK;
        const float *distance_m = layout_distances(state->layout, state->params.distance, sensor, at, count, scratch);
        most_m = kernel_largest(distance_m, count, most_m);
        for (size_t j = 0; j < count; j++)
            state->at[at + j].value = distance_m[j];
    }
    for (size_t j = 0; j < scalars->count; j++)
        if (!(state->at[j].value <= FLT_MAX))
            state->at[j] = (struct scalar){ .value = most_m, .lacking = FLAG, .no_data = FLAG };
    scalars->version = scalars->flags_version = ++*versions;
    scalars->ready = scalars->count;
}
