/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From changed readings to changed scalars: all columns anew, or only the columns of what changed. */
#include "field/state.h"

#include <float.h>
#include <math.h>
#include <pthread.h>
#include <string.h>

#include "base/mem.h"
#include "field/limits.h"
#include "field/scalars.h"
#include "value/quality.h"

#define FLAG 255
#define READING_LIMIT 1e30  /* beyond it sums of floats would overflow */
#define STEP_LIMIT 1e6      /* times the range: a larger step would leave its rounding in the sum for good */
#define ADDED_MOST 4096     /* updates before all is summed anew: what rounding leaves behind stays below 1e-9 of the range */
#define STEPS_PER_JOB 65536 /* columns times vertices: worth waking another thread for */

struct state *state_create(int asset, struct layout *layout, const struct field_params *params)
{
    struct state *state = mem_new(sizeof(*state));
    state->params = *params;
    state->layout = layout;
    state->at = mem_try_array(layout->vertex_count, sizeof(*state->at));
    state->sums = mem_try_array(layout->vertex_count, sizeof(*state->sums));
    state->scalars = (struct scalars){ .asset = asset, .count = layout->vertex_count, .at = state->at };
    state->now = mem_array(layout->sensor_count, sizeof(*state->now));
    state->shown = mem_array(layout->sensor_count, sizeof(*state->shown));
    state->usable = mem_array(layout->sensor_count, 1);
    state->list = mem_array(layout->sensor_count, sizeof(*state->list));
    state->factors = mem_array(layout->sensor_count, sizeof(*state->factors));
    state->marked = mem_array(layout->sensor_count, 1);
    if (!state->at || !state->sums)
        state_destroy(&state);
    return state;
}

void state_destroy(struct state **state_ptr)
{
    struct state *state = *state_ptr;
    if (!state)
        return;
    mem_free(state->at);
    mem_free(state->sums);
    mem_free(state->now);
    mem_free(state->shown);
    mem_free(state->usable);
    mem_free(state->list);
    mem_free(state->factors);
    mem_free(state->marked);
    mem_free(state);
    *state_ptr = NULL;
}

size_t state_bytes(const struct layout *layout)
{
    size_t each_sensor = 2 * sizeof(struct state_input) + 2 + sizeof(uint32_t) + sizeof(double);
    return sizeof(struct state) + layout->vertex_count * (sizeof(struct scalar) + sizeof(double)) + layout->sensor_count * each_sensor;
}

static double limited(double x, double low, double high)
{
    return x < low ? low : x > high ? high : x;
}

static double value_of(const struct state *state, const struct plant_tag *tag, double reading)
{
    const struct plant_group *group = state->layout->group;
    if (state->params.show == SHOW_OPERATOR)
        return (float)limit_place(group, tag, reading);
    if (state->params.interpolation == INTERPOLATION_PAPER)
        return (float)limited((reading - group->min) / (group->max - group->min), 0, 1);
    return (float)limited(reading, -READING_LIMIT, READING_LIMIT);
}

static struct state_input input_of(const struct state *state, const struct plant_tag *tag, const struct reading *reading)
{
    bool good = !quality_is_bad(reading->quality) && isfinite(reading->value);
    double value = good ? value_of(state, tag, reading->value) : 0;
    return (struct state_input){
        .value = isfinite(value) ? value : 0,
        .usable = !good ? SENSOR_LOST : isfinite(value) ? SENSOR_USED : SENSOR_NO_LIMITS,
        .uncertain = good && quality_is_uncertain(reading->quality),
    };
}

/* Only sensors that may be used in both take part: else a sensor that came or went would show as a change of the plant. */
static struct state_input less(struct state_input now, struct state_input then)
{
    bool usable = now.usable && then.usable;
    return (struct state_input){
        .value = usable ? now.value - then.value : 0,
        .usable = usable,
        .uncertain = usable && (now.uncertain || then.uncertain),
    };
}

void state_read(struct state *state, const struct snapshot *snapshot, const struct snapshot *baseline)
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
        state->usable[i] = state->now[i].usable;
        if (state->usable[i] && reading->age_ns > oldest_ns)
            oldest_ns = reading->age_ns;
    }
    state->scalars.oldest_age_ns = oldest_ns >= 0 ? oldest_ns : INT64_MAX;
}

bool state_needs_weights(const struct state *state)
{
    for (size_t i = 0; i < state->layout->sensor_count; i++)
        if (state->now[i].usable != state->shown[i].usable)
            return true;
    return !state->weights;
}

static bool marks_differ(const struct state *state)
{
    for (size_t i = 0; i < state->layout->sensor_count; i++)
        if (state->now[i].uncertain != state->shown[i].uncertain)
            return true;
    return false;
}

bool state_is_behind(const struct state *state)
{
    if (state->scalars.version == 0)
        return true;
    for (size_t i = 0; i < state->layout->sensor_count; i++) {
        const struct state_input *now = &state->now[i], *shown = &state->shown[i];
        if (now->usable != shown->usable || now->uncertain != shown->uncertain || now->value != shown->value)
            return true;
    }
    return false;
}

struct update {
    struct state *state;
    struct weights_terms terms;
    struct kernel_value rule;
    bool fresh; /* the weights are not prepared yet */
    bool anew;  /* sum all columns; else add to what is there */
    bool marks; /* some sensor is Uncertain */
    pthread_mutex_t lock;
    /* --- below: under lock */
    bool value_changed, flag_changed;
    float most;
};

/* Members to add: all, or those that changed. */
static void choose_terms(struct update *update)
{
    struct state *state = update->state;
    const struct weights *weights = state->weights;
    size_t count = 0;
    for (uint32_t m = 0; m < weights->member_count; m++) {
        const struct state_input *now = &state->now[weights->members[m]], *shown = &state->shown[weights->members[m]];
        double factor = update->anew ? now->value : now->value - shown->value;
        if (!update->anew && factor == 0)
            continue;
        state->list[count] = m;
        state->factors[count] = factor;
        state->marked[count++] = now->uncertain;
        update->marks |= now->uncertain;
    }
    update->terms = (struct weights_terms){ .members = state->list, .factors = state->factors, .marked = state->marked, .count = count };
}

/* Adding is cheaper for few changes; a step far beyond the range would leave its rounding behind. */
static bool steps_are_small(const struct update *update)
{
    const struct state *state = update->state;
    double limit =
        state->params.interpolation == INTERPOLATION_PAPER ? 2 : STEP_LIMIT * (state->layout->group->max - state->layout->group->min);
    for (size_t i = 0; i < update->terms.count; i++)
        if (!(fabs(update->terms.factors[i]) < limit))
            return false;
    return update->terms.count * 2 <= state->weights->member_count;
}

static void choose_rule(struct update *update)
{
    const struct state *state = update->state;
    const struct plant_group *group = state->layout->group;
    bool difference = state->params.show == SHOW_DIFFERENCE, places = state->params.show == SHOW_OPERATOR;
    if (state->params.interpolation == INTERPOLATION_PAPER && places) {
        update->rule = (struct kernel_value){ .scale = 1, .low = -(float)LIMIT_PLACE_MOST, .high = (float)LIMIT_PLACE_MOST };
    } else if (state->params.interpolation == INTERPOLATION_PAPER) {
        float scale = (float)(group->max - group->min), offset = difference ? 0 : (float)group->min;
        update->rule = (struct kernel_value){
            .scale = scale, .offset = offset, .low = difference ? -scale : offset, .high = difference ? scale : (float)group->max
        };
    } else {
        update->rule = (struct kernel_value){ .scale = 1, .low = FLT_MAX, .high = -FLT_MAX };
        for (size_t m = 0; m < state->weights->member_count; m++) {
            float value = (float)state->now[state->weights->members[m]].value;
            update->rule.low = fminf(update->rule.low, value);
            update->rule.high = fmaxf(update->rule.high, value);
        }
    }
    update->rule.empty = difference || places ? 0 : (float)group->min;
}

static bool set_flags(const struct update *update, size_t begin, size_t count, const double *total, const double *marked)
{
    const uint8_t *place = update->state->weights->place + begin;
    struct scalar *at = update->state->at + begin;
    bool fill = update->state->params.fill == FILL_NEIGHBOURS, changed = false;
    for (size_t j = 0; j < count; j++) {
        bool filled = fill && place[j] == PLACE_LOST;
        uint8_t no_limits = place[j] == PLACE_NO_LIMITS ? FLAG : 0;
        uint8_t no_data = place[j] == PLACE_GOOD || filled || no_limits ? 0 : FLAG;
        uint8_t uncertain = filled || (update->marks && total[j] > 0 && 2 * marked[j] >= total[j]) ? FLAG : 0;
        changed |= at[j].no_data != no_data || at[j].uncertain != uncertain || at[j].no_limits != no_limits;
        at[j].no_limits = no_limits;
        at[j].no_data = no_data;
        at[j].uncertain = uncertain;
    }
    return changed;
}

/* Returns whether a flag changed. */
static bool sum_block(const struct update *update, size_t begin, size_t count)
{
    struct weights *weights = update->state->weights;
    double total[KERNEL_BLOCK], marked[KERNEL_BLOCK];
    struct weights_sums sums = { .values = update->state->sums + begin };
    if (!update->anew) {
        weights_add(weights, begin, count, &update->terms, &sums);
        return false;
    }
    if (update->fresh)
        weights_prepare(weights, begin, count);
    bool total_wanted = update->fresh && !weights->known_total;
    if (total_wanted || update->marks)
        sums.total = memset(total, 0, sizeof(total));
    if (update->marks)
        sums.marked = memset(marked, 0, sizeof(marked));
    memset(sums.values, 0, count * sizeof(*sums.values));
    weights_add(weights, begin, count, &update->terms, &sums);
    for (size_t j = 0; total_wanted && j < count; j++)
        weights->total[begin + j] = (float)total[j];
    return set_flags(update, begin, count, total, marked);
}

static void update_blocks(void *arg, size_t begin, size_t end)
{
    struct update *update = arg;
    struct state *state = update->state;
    float values[KERNEL_BLOCK], most = 0;
    bool value_changed = false, flag_changed = false;
    for (size_t at = begin * KERNEL_BLOCK; at < end * KERNEL_BLOCK && at < state->scalars.count; at += KERNEL_BLOCK) {
        size_t left = state->scalars.count - at, count = left < KERNEL_BLOCK ? left : KERNEL_BLOCK;
        flag_changed |= sum_block(update, at, count);
        kernel_value(&update->rule, state->sums + at, state->weights->total + at, count, values);
        most = fmaxf(most, kernel_store(values, count, state->at + at, &value_changed));
    }
    pthread_mutex_lock(&update->lock);
    update->value_changed |= value_changed;
    update->flag_changed |= flag_changed;
    update->most = fmaxf(update->most, most);
    pthread_mutex_unlock(&update->lock);
}

static void run_update(struct update *update, struct workers *workers)
{
    size_t steps = (update->terms.count + 8) * KERNEL_BLOCK;
    size_t grain = steps < STEPS_PER_JOB ? STEPS_PER_JOB * 2 / steps : 2;
    pthread_mutex_init(&update->lock, NULL);
    workers_for(workers, (update->state->scalars.count + KERNEL_BLOCK - 1) / KERNEL_BLOCK, grain, update_blocks, update);
    pthread_mutex_destroy(&update->lock);
    weights_added(update->state->weights, &update->terms);
}

void state_update(struct state *state, struct workers *workers, bool fresh, uint64_t *versions)
{
    struct scalars *scalars = &state->scalars;
    bool first = scalars->version == 0;
    struct update update = { .state = state, .fresh = fresh, .anew = first || fresh || marks_differ(state) || state->added >= ADDED_MOST };
    for (size_t i = 0; !update.anew && i < state->layout->sensor_count; i++)
        update.anew = state->now[i].usable != state->shown[i].usable;
    choose_terms(&update);
    if (!update.anew && !steps_are_small(&update)) {
        update.anew = true;
        choose_terms(&update);
    }
    state->added = update.anew ? 0 : state->added + 1;
    choose_rule(&update);
    run_update(&update, workers);
    memcpy(state->shown, state->now, state->layout->sensor_count * sizeof(*state->now));
    if (first || update.value_changed || update.flag_changed)
        scalars->version = ++*versions;
    if (first || update.flag_changed)
        scalars->flags_version = scalars->version;
    scalars->travel += update.most;
}

void state_measure(struct state *state, size_t sensor, uint64_t *versions)
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
            state->at[j] = (struct scalar){ .value = most_m, .no_data = FLAG };
    scalars->version = scalars->flags_version = ++*versions;
}
