/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes derived tags, whose values are expressions of other tags' values. */
#include "value/derived.h"

#include <errno.h>
#include <math.h>

#include "base/clock.h"
#include "base/mem.h"
#include "plant/tags/expression.h"
#include "value/decode.h"
#include "value/lookup.h"
#include "value/quality.h"
#include "value/source_impl.h"

static const int64_t ROUND_NS = 200 * NS_PER_MS;

struct written {
    double value;
    uint32_t quality;
    int64_t mono_ns; /* monotonic time of the result that was written last; INT64_MIN: none was written yet */
};

struct derived_state {
    const struct plant *plant;
    struct snapshot *snapshot;
    struct written *written; /* results of derived tags that were written to the store last, by index in plant->derived */
};

struct derived_source {
    struct source base;
    struct derived_state *state;
};

struct derived_state *derived_create(const struct plant *plant)
{
    struct derived_state *state = mem_new(sizeof(*state));
    state->plant = plant;
    state->snapshot = snapshot_create(plant->tag_count);
    state->written = mem_array(plant->derived_count, sizeof(*state->written));
    for (size_t i = 0; i < plant->derived_count; i++)
        state->written[i] = (struct written){ 0, QUALITY_BAD_WAITING, INT64_MIN };
    return state;
}

void derived_destroy(struct derived_state **state)
{
    if (!*state)
        return;
    snapshot_destroy(&(*state)->snapshot);
    mem_free((*state)->written);
    mem_free(*state);
    *state = NULL;
}

/* Evaluates a derived tag's expression in the units of the tag list. The result has the worst quality of its inputs and its own
   measuring range, and the age of the newest input. */
static struct reading combine(const struct derived_state *state, const struct plant_tag *tag)
{
    const struct plant *plant = state->plant;
    const int *inputs;
    size_t count = expression_inputs(tag->expression, &inputs);
    struct reading all = { .quality = QUALITY_GOOD, .age_ns = count ? INT64_MAX : 0 };
    double values[EXPRESSION_INPUTS];
    for (size_t i = 0; i < count; i++) {
        const struct reading *one = &state->snapshot->readings[inputs[i]];
        values[i] = unit_change_back(&plant->tags[inputs[i]].scale.change, one->value);
        if (quality_is_worse(one->quality, all.quality))
            all.quality = one->quality;
        if (one->age_ns < all.age_ns)
            all.age_ns = one->age_ns;
    }
    if (quality_is_bad(all.quality))
        return all;
    double value = expression_value(tag->expression, values);
    uint32_t quality = decode_quality(tag, value);
    if (quality_is_worse(quality, all.quality))
        all.quality = quality;
    all.value = quality_is_bad(quality) ? 0 : unit_change_value(&tag->scale.change, value);
    return all;
}

/* Writes a derived tag's result to the store only if an input is newer than at the last write, or value or quality differ.
   Writing an unchanged result would make it look newer than its inputs. Inputs have the times that their devices state, so an
   input that arrives late may change the value without being the newest. */
static void write_new(struct derived_state *state, struct store *store, size_t i, struct reading *reading)
{
    struct written *written = &state->written[i];
    const struct snapshot *snapshot = state->snapshot;
    bool known = reading->age_ns != INT64_MAX;
    int64_t mono_ns = known && !quality_is_bad(reading->quality) ? snapshot->taken_mono_ns - reading->age_ns : snapshot->taken_mono_ns;
    if (mono_ns < written->mono_ns)
        mono_ns = written->mono_ns;
    bool same_value = quality_is_bad(reading->quality) || (mono_ns == written->mono_ns && reading->value == written->value);
    if (reading->quality == written->quality && same_value)
        return;
    *written = (struct written){ reading->value, reading->quality, mono_ns };
    const struct sample sample = { .tag = state->plant->derived[i], .value = reading->value, .quality = reading->quality };
    store_write(store, &sample, 1, mono_ns, snapshot->taken_utc_ns - (snapshot->taken_mono_ns - mono_ns));
}

void derived_compute(struct derived_state *state, struct store *store, int64_t now_mono_ns, int64_t now_utc_ns)
{
    const struct plant *plant = state->plant;
    store_snapshot(store, now_mono_ns, now_utc_ns, state->snapshot);
    for (size_t i = 0; i < plant->derived_count; i++) {
        struct reading *reading = &state->snapshot->readings[plant->derived[i]];
        /* also puts the result into the snapshot, because later derived tags may use it as an input */
        *reading = combine(state, &plant->tags[plant->derived[i]]);
        write_new(state, store, i, reading);
    }
}

static void derived_run(struct source *source)
{
    struct derived_source *derived = (struct derived_source *)source;
    while (wait_for(-1, 0, source->stop_fd, clock_mono_ns() + ROUND_NS) != -ECANCELED)
        derived_compute(derived->state, source->store, clock_mono_ns(), clock_utc_ns());
}

static struct source *derived_make(const struct source *base, struct counters *counters)
{
    struct derived_source *derived = mem_new(sizeof(*derived));
    (void)counters; /* derived tags have no counters */
    derived->base = *base;
    derived->state = derived_create(base->plant);
    return &derived->base;
}

static void derived_free(struct source *source)
{
    struct derived_source *derived = (struct derived_source *)source;
    derived_destroy(&derived->state);
    mem_free(derived);
}

static const struct source_impl derived_impl = { .kind = "derived", .create = derived_make, .run = derived_run, .destroy = derived_free };

struct source *derived_start(struct log *log, const struct plant *plant, struct store *store)
{
    const struct source base = { .impl = &derived_impl, .log = log, .plant = plant, .index = -1, .store = store };
    return source_begin(&base, "derived tags", NULL);
}
