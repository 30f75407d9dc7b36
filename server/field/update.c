/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Updates the scalars of a field, one block of KERNEL_BLOCK vertices at a time: sums the weighted readings of all sensors, or
   adds only the changes of readings. */
#include "field/update.h"

#include <float.h>
#include <math.h>
#include <pthread.h>
#include <string.h>

#include "base/mem.h"
#include "field/limits.h"
#include "field/scalars.h"
#include "plant/influence.h"

#define FLAG 255
/* Share of a lost sensor's value that the readings of other sensors determine, above which it counts. Less is only rounding. */
#define DETERMINED 1e-9
/* error as a fraction of the colour range; vertices of triangles that may be drawn with a larger error are marked uncertain */
#define DRAWN_ERROR (1 / 255.0)
/* factor by which a newly chosen limit on errors is stricter than necessary, so that it stays valid when readings change
   slightly */
#define ERROR_MARGIN 1.1
/* state->error_limit (error above which a vertex is marked uncertain) is replaced if it is stricter than necessary by more than
   this factor */
#define ERROR_SLACK 1.5
/* Upper limit on the values of SHOW_BLIND, in multiples of the group's range. Such a value is the excess over its surroundings
   that a hot spot at the vertex needs for a sensor to notice it. */
#define MAX_BLIND 1000.0
/* largest change of a reading, in multiples of the range, that is added to existing sums, where its rounding error remains.
   After a larger change, everything is summed again */
#define STEP_LIMIT 1e6
/* number of updates after which everything is summed again, which keeps the accumulated rounding below 1e-9 of the range */
#define MAX_ADDED 4096
/* estimated work, in nanoseconds, of one of the pieces into which an update is divided for the threads; less work is not worth
   waking a thread */
#define JOB_WORK 30000.0
/* estimated work in nanoseconds below which the update of an asset stays on one thread, while several assets are updated in
   parallel */
#define SMALL_WORK 1e6
#define MAKE_WORK 1.0    /* estimated nanoseconds to compute one sensor's weight at one vertex and add it */
#define ADD_WORK 0.15    /* estimated nanoseconds to add a weight that is already computed */

struct update {
    struct field_state *state;
    struct weights_terms all, changed;
    struct kernel_value rule;
    /* indices of blocks of vertices. next: block to update next; old: end of the blocks that already had values; end: end of
       the blocks that need values */
    size_t next, old, end;
    /* true: computes each vertex's sum over all sensors again; false: in blocks with existing sums (below `old`), adds only the
       changes of readings to these sums */
    bool sums_all;
    /* true: qualities changed, so the flags (no data, uncertain) of all vertices are set; false: only those of new vertices,
       from block `old` on */
    bool flags;
    bool marks; /* true: at least one reading in the sum has the quality Uncertain */
    pthread_mutex_t lock;
    /* --- below: under lock */
    bool value_changed, flag_changed;
    float most;
};

static size_t blocks_of(size_t vertex_count)
{
    return (vertex_count + KERNEL_BLOCK - 1) / KERNEL_BLOCK;
}

/* --- choosing the work ------------------------------------------------------------------------------------------------------ */

/* Lists the sensors to sum: all sensors of the weights or, if only changes are added, the sensors whose input changed. */
static struct weights_terms choose_terms(struct field_state *state, bool all)
{
    const struct weights *weights = state->weights;
    struct state_list *list = &state->lists[all];
    size_t count = 0;
    for (uint32_t m = 0; m < weights->member_count; m++) {
        const struct state_input *now = &state->now[weights->members[m]], *shown = &state->shown[weights->members[m]];
        double factor = all ? now->value : now->value - shown->value;
        if (!all && factor == 0)
            continue;
        list->members[count] = m;
        list->factors[count] = factor;
        list->marked[count++] = now->uncertain;
    }
    return (struct weights_terms){ .members = list->members, .factors = list->factors, .marked = list->marked, .count = count };
}

/* Returns true if changes may be added to the existing sums: they are few, so that adding is cheaper than summing again, and
   small, so that their rounding errors do not matter. */
static bool steps_are_small(const struct update *update)
{
    const struct field_state *state = update->state;
    double limit =
        state->params.interpolation == INTERPOLATION_PAPER ? 2 : STEP_LIMIT * (state->layout->group->max - state->layout->group->min);
    for (size_t i = 0; i < update->changed.count; i++)
        if (!(fabs(update->changed.factors[i]) < limit))
            return false;
    return update->changed.count * 2 <= state->weights->member_count;
}

void update_rule(const struct field_state *state, const struct state_input *inputs, struct kernel_value *rule)
{
    const struct plant_group *group = state->layout->group;
    bool difference = state->params.show == SHOW_DIFFERENCE, places = state->params.show == SHOW_OPERATOR;
    if (state->params.interpolation == INTERPOLATION_PAPER && places) {
        *rule = (struct kernel_value){ .scale = 1, .low = -(float)LIMIT_PLACE_MOST, .high = (float)LIMIT_PLACE_MOST };
    } else if (state->params.interpolation == INTERPOLATION_PAPER) {
        float scale = (float)(group->max - group->min), offset = difference ? 0 : (float)group->min;
        *rule = (struct kernel_value){
            .scale = scale, .offset = offset, .low = difference ? -scale : offset, .high = difference ? scale : (float)group->max
        };
    } else {
        /* The interpolation fin sums differences from the ambient value, and `offset` adds ambient back. A sum of 0 is
           therefore valid and means ambient. */
        bool around = state->params.interpolation == INTERPOLATION_FIN;
        float offset = around && !difference && !places ? (float)group->ambient : 0;
        *rule = (struct kernel_value){ .scale = 1, .offset = offset, .low = around ? offset : FLT_MAX, .high = around ? offset : -FLT_MAX };
        /* does not clamp values of interpolation gp (Gaussian process): they may lie outside the range of the readings */
        if (state->params.interpolation == INTERPOLATION_GP)
            rule->low = -FLT_MAX, rule->high = FLT_MAX;
        for (size_t m = 0; m < state->weights->member_count; m++) {
            float value = (float)inputs[state->weights->members[m]].value;
            rule->low = fminf(rule->low, value + offset);
            rule->high = fmaxf(rule->high, value + offset);
        }
    }
    rule->empty = difference || places ? 0 : (float)group->min;
}

/* Returns the factor that converts an error of the weights (weights->errors) to the largest error of a value. The errors of all
   weights at a point add up to 0, so the factor is the spread of the readings. With `fin` they do not, so ambient counts as one
   more reading. */
static double error_scale(const struct field_state *state)
{
    const struct weights *weights = state->weights;
    double low = INFINITY, high = -INFINITY;
    for (size_t m = 0; m < weights->member_count; m++) {
        uint32_t i = weights->members[m];
        /* a lost sensor whose value no other sensor determines, because it is the only one on its body, has a value of 0 */
        if (weights->ones && !weights->takes_part[i] && fabs(weights->ones[i]) < DETERMINED)
            continue;
        double value = state->now[i].value;
        low = fmin(low, value);
        high = fmax(high, value);
    }
    if (!(low <= high))
        return 0;
    if (state->params.interpolation == INTERPOLATION_FIN)
        return fmax(high, 0) - fmin(low, 0);
    if (state->params.interpolation != INTERPOLATION_PAPER)
        return high - low;
    const struct plant_group *group = state->layout->group;
    double unit = state->params.show == SHOW_OPERATOR ? 1 : group->max - group->min;
    return unit * fmax(fabs(low), fabs(high));
}

/* Returns the width of the colour map's range, relative to which errors of drawn values are judged. */
static double error_range(const struct field_state *state)
{
    const struct plant_group *group = state->layout->group;
    return state->params.show == SHOW_OPERATOR     ? 2 * LIMIT_PLACE_MOST
           : state->params.show == SHOW_DIFFERENCE ? 0.5 * (group->max - group->min)
                                                   : group->max - group->min;
}

bool update_is_in_range(const struct field_state *state)
{
    return error_scale(state) <= error_range(state);
}

/* Chooses the limit on errors of the weights above which vertices are marked uncertain. The limit stays while it is safe and
   not much too strict, so that slightly changed readings do not rebuild all flags. Returns true if the flags must be set again. */
static bool choose_error_limit(struct field_state *state)
{
    const struct weights *weights = state->weights;
    double scale = weights->errors || weights->errors_unknown ? error_scale(state) : 0;
    double limit = scale > 0 ? DRAWN_ERROR * error_range(state) / scale : INFINITY;
    bool measured = state->errors_version != weights->errors_version;
    bool seen = measured || (double)weights->largest_error > fmin(limit, state->error_limit);
    state->errors_version = weights->errors_version;
    state->error_scale = scale;
    if (limit >= state->error_limit && limit <= ERROR_SLACK * state->error_limit)
        return measured;
    state->error_limit = limit / ERROR_MARGIN;
    return seen;
}

static bool qualities_changed(const struct field_state *state)
{
    if (state->scalars.version == 0)
        return true;
    for (size_t i = 0; i < state->layout->sensor_count; i++)
        if (state->now[i].usable != state->shown[i].usable || state->now[i].uncertain != state->shown[i].uncertain)
            return true;
    return false;
}

void update_begin(struct field_state *state, size_t count)
{
    size_t wanted = state->wanted > count ? state->wanted : count;
    struct update *update = mem_new(sizeof(*update));
    *update = (struct update){ .state = state, .old = blocks_of(state->scalars.ready), .end = blocks_of(wanted) };
    update->all = choose_terms(state, true);
    update->changed = choose_terms(state, false);
    update->flags = qualities_changed(state);
    update->flags |= choose_error_limit(state);
    update->sums_all = !state->sums || update->flags || state->added >= MAX_ADDED || !steps_are_small(update);
    for (size_t i = 0; i < update->all.count; i++)
        update->marks |= update->all.marked[i];
    /* if no input changed: computes only new blocks, and leaves the blocks that have values unchanged */
    if (!update->sums_all && update->changed.count == 0)
        update->next = update->old;
    update_rule(state, state->now, &update->rule);
    pthread_mutex_init(&update->lock, NULL);
    state->added = update->sums_all ? 0 : state->added + 1;
    state->wanted = count;
    state->update = update;
}

/* --- block by block --------------------------------------------------------------------------------------------------------- */

/* Returns a vertex's byte for `uncertain` of struct scalars: the larger of `filled`, the byte of a value filled in around a
   lost sensor, and the byte for the weight of Uncertain sensors. That weight is the fraction marked / total. */
static uint8_t uncertain_of(double marked, double total, uint8_t filled)
{
    /* `part` is 1 if Uncertain sensors have half of the total weight. Weights of interpolation gp (Gaussian process) may be
       negative, so `total` may be 0 and `part` above 2. */
    double part = total > 0 && marked > 0 ? 2 * marked / total : 0;
    uint8_t leans = (uint8_t)(part >= 1 ? 128 + (int)(127 * (fmin(part, 2) - 1)) : (int)(127 * part));
    return leans > filled ? leans : filled;
}

void update_flags(const struct field_state *state, const struct weights *weights, size_t vertex, double total, double marked,
                  struct scalar *at)
{
    /* vertices around lost sensors (those without a usable reading) have data, too, if the field shows SHOW_BLIND */
    bool blind = state->params.show == SHOW_BLIND;
    bool fill = blind || state->params.fill == FILL_NEIGHBOURS, filled = fill && weights->place[vertex] == PLACE_LOST;
    at->no_limits = weights->place[vertex] == PLACE_NO_LIMITS ? FLAG : 0;
    at->no_data = weights->place[vertex] == PLACE_GOOD || filled || at->no_limits ? 0 : FLAG;
    uint8_t spread = fill && !blind && at->no_data == 0 && !at->no_limits ? weights->lost[vertex] : 0;
    at->uncertain = uncertain_of(marked, total, spread);
    at->lacking = weights_lacking_at(weights, vertex, filled);
    const float error = field_params_cover(&state->params) ? 0 : weights_error_at(weights, vertex);
    if ((blind && weights_blind_off(weights, vertex)) || (double)error > state->error_limit || error >= WEIGHTS_SHOWS_NO_DATA)
        at->uncertain = FLAG;
}

static bool set_flags(const struct update *update, size_t begin, size_t count, const double *total, const double *marked)
{
    struct scalar *at = update->state->at + begin;
    bool changed = false;
    for (size_t j = 0; j < count; j++) {
        struct scalar now = { .value = at[j].value };
        update_flags(update->state, update->state->weights, begin + j, update->marks ? total[j] : 0, update->marks ? marked[j] : 0, &now);
        changed |= at[j].lacking != now.lacking || at[j].no_data != now.no_data || at[j].uncertain != now.uncertain ||
                   at[j].no_limits != now.no_limits;
        at[j] = now;
    }
    return changed;
}

/* Sums the weighted readings of all sensors at a block of vertices into `values`. Returns true if a
   vertex's flag (no data, uncertain or no limits) changed. */
static bool sum_block(const struct update *update, size_t block, size_t begin, size_t count, double *values)
{
    struct weights *weights = update->state->weights;
    double total[KERNEL_BLOCK], marked[KERNEL_BLOCK];
    struct weights_sums sums = { .values = values };
    if (!update->sums_all && block < update->old) {
        weights_add(weights, begin, count, &update->changed, &sums);
        return false;
    }
    bool total_wanted = !(weights->known[block] & KNOWN_TOTAL), flags = update->flags || block >= update->old;
    weights_prepare(weights, begin, count);
    if (total_wanted || (flags && update->marks))
        sums.total = memset(total, 0, sizeof(total));
    if (flags && update->marks)
        sums.marked = memset(marked, 0, sizeof(marked));
    memset(sums.values, 0, count * sizeof(*sums.values));
    weights_add(weights, begin, count, &update->all, &sums);
    for (size_t j = 0; total_wanted && j < count; j++)
        weights->total[begin + j] = (float)total[j];
    if (total_wanted) /* does not write totals (sums of weights) that are known already, because other threads may be reading them */
        weights->known[block] |= KNOWN_TOTAL;
    return flags && set_flags(update, begin, count, total, marked);
}

float update_blind(const struct plant_group *group, float near_m)
{
    double far = (double)near_m / group->hot_spot_m, most = MAX_BLIND * (group->max - group->min);
    return (float)fmin(PLANT_SEEN_PART * (group->max - group->min) * exp(far * far / 2), most);
}

/* Computes a block of SHOW_UNCERTAINTY or SHOW_BLIND, which depend on which sensors are good, but not on their readings.
   Returns true if a flag changed. */
static bool map_block(const struct update *update, size_t begin, size_t count, float *values)
{
    const struct field_state *state = update->state;
    struct weights *weights = state->weights;
    const double nothing[KERNEL_BLOCK] = { 0 };
    weights_prepare(weights, begin, count);
    if (state->params.show == SHOW_UNCERTAINTY)
        weights_deviations(weights, begin, count, values);
    for (size_t j = 0; state->params.show == SHOW_BLIND && j < count; j++)
        values[j] = update_blind(state->layout->group, weights->near_m[begin + j]);
    return set_flags(update, begin, count, nothing, nothing);
}

/* Returns true if the fast path kernel_few() can compute this block: few sensors, all their weights cached, and no flags to
   set. */
static bool is_simple(const struct update *update, size_t block, size_t begin)
{
    return !field_params_cover(&update->state->params) && !update->state->sums && !update->flags && block < update->old &&
           update->all.count > 0 && update->all.count < KERNEL_COLUMNS && weights_is_complete(update->state->weights, begin);
}

static float sum_few(const struct update *update, size_t begin, size_t count, bool *changed)
{
    const struct weights *weights = update->state->weights;
    struct kernel_columns columns = { .count = update->all.count };
    for (size_t k = 0; k < columns.count; k++) {
        columns.column[k] = weights_column(weights, begin, update->all.members[k]);
        columns.factor[k] = update->all.factors[k];
    }
    return kernel_few(&update->rule, &columns, weights->total + begin, count, update->state->at + begin, changed);
}

static void update_blocks(void *arg, size_t begin, size_t end)
{
    struct update *update = arg;
    struct field_state *state = update->state;
    float values[KERNEL_BLOCK], most = 0;
    double room[KERNEL_BLOCK];
    bool value_changed = false, flag_changed = false;
    for (size_t block = update->next + begin; block < update->next + end; block++) {
        size_t at = block * KERNEL_BLOCK, left = state->scalars.count - at, count = left < KERNEL_BLOCK ? left : KERNEL_BLOCK;
        if (is_simple(update, block, at)) {
            most = fmaxf(most, sum_few(update, at, count, &value_changed));
            continue;
        }
        if (field_params_cover(&state->params)) {
            flag_changed |= map_block(update, at, count, values);
            most = fmaxf(most, kernel_store(values, count, state->at + at, &value_changed));
            continue;
        }
        double *sums = state->sums ? state->sums + at : room;
        flag_changed |= sum_block(update, block, at, count, sums);
        kernel_value(&update->rule, sums, state->weights->total + at, count, values);
        most = fmaxf(most, kernel_store(values, count, state->at + at, &value_changed));
    }
    pthread_mutex_lock(&update->lock);
    update->value_changed |= value_changed;
    update->flag_changed |= flag_changed;
    update->most = fmaxf(update->most, most);
    pthread_mutex_unlock(&update->lock);
}

static double block_work(const struct update *update, size_t block)
{
    const struct weights *weights = update->state->weights;
    bool step = !update->sums_all && block < update->old, kept = weights_has_columns(weights, block * KERNEL_BLOCK);
    bool whole = !step && (!(weights->known[block] & KNOWN_TOTAL) || update->marks);
    double each = kept && !(whole && weights->interpolation == INTERPOLATION_PAPER) ? ADD_WORK : MAKE_WORK;
    return KERNEL_BLOCK * ((double)(step ? update->changed.count : update->all.count) * each + 4);
}

bool update_is_light(const struct field_state *state)
{
    const struct update *update = state->update;
    const struct weights *weights = state->weights;
    double work = 0;
    if (weights->interpolation == INTERPOLATION_PAPER && update->marks)
        return false;
    for (size_t block = update->next; block < update->end; block++) {
        if (!weights_is_complete(weights, block * KERNEL_BLOCK))
            return false;
        work += block_work(update, block);
    }
    return work < SMALL_WORK;
}

void update_run(struct field_state *state)
{
    struct update *update = state->update;
    update_blocks(update, 0, update->end - update->next);
    update->next = update->end;
}

/* A legend gives an error bound only if errors exceed 1/255 of the range on more than this fraction of an asset's surface.
   Preparation does not subdivide triangles that nobody sees (inside bodies, and at jumps of distance), which are up to a
   quarter of the surface of the demo's machines. These triangles are marked and picks report them, but a number in the legend
   would warn of errors that no frame shows. */
static const float MIN_LEGEND_SHARE = 0.3f;

static double drawn_error(const struct field_state *state)
{
    const struct weights *weights = state->weights;
    double error = field_params_cover(&state->params) ? 0 : (double)weights->largest_error;
    if (error <= state->error_limit)
        return 0;
    int b = (int)ceil(-log2(state->error_limit));
    b = b < 0 ? 0 : b < WEIGHTS_ERRING ? b : WEIGHTS_ERRING - 1;
    return weights->erring[b] >= MIN_LEGEND_SHARE ? error * state->error_scale : 0;
}

void update_end(struct field_state *state, uint64_t *versions)
{
    struct update *update = state->update;
    struct scalars *scalars = &state->scalars;
    bool first = scalars->version == 0, grown = update->end > update->old;
    memcpy(state->shown, state->now, state->layout->sensor_count * sizeof(*state->now));
    scalars->ready = update->end * KERNEL_BLOCK < scalars->count ? update->end * KERNEL_BLOCK : scalars->count;
    scalars->drawn_error = drawn_error(state);
    scalars->grown += grown;
    if (first || grown || update->value_changed || update->flag_changed)
        scalars->version = ++*versions;
    if (first || grown || update->flag_changed)
        scalars->flags_version = scalars->version;
    scalars->travel += (double)update->most;
    update_forget(state);
}

bool update_go_on(struct field_state *state, struct workers *workers, double work, uint64_t *versions)
{
    struct update *update = state->update;
    double done = 0;
    size_t count = 0;
    while (update->next + count < update->end && (count == 0 || done < work))
        done += block_work(update, update->next + count++);
    size_t grain = (size_t)(JOB_WORK * (double)count / (done + 1)) + 1;
    workers_for(workers, count, grain, update_blocks, update);
    update->next += count;
    if (update->next < update->end)
        return false;
    update_end(state, versions);
    return true;
}

void update_forget(struct field_state *state)
{
    if (!state->update)
        return;
    pthread_mutex_destroy(&state->update->lock);
    mem_free(state->update);
    state->update = NULL;
}
