/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A source that replays recorded series: writes each sample to the store when its time comes. */
#include "value/source_impl.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>

#include "base/clock.h"
#include "base/mem.h"
#include "value/decode.h"
#include "value/lookup.h"
#include "value/quality.h"
#include "value/series.h"

static const int64_t ROUND_NS = 50 * NS_PER_MS;
/* maximum time by which a sample may be written late: samples later than this are skipped, for example after the machine slept */
static const int64_t LATEST_NS = 10 * NS_PER_S;

struct replay_lane { /* a tag and the series that it replays */
    int tag;
    struct unit_change change; /* conversion from the series' unit to the tag's unit */
    struct series series;      /* samples of the tag's series; count 0: the tag has no series */
    size_t next;
    int64_t rounds; /* number of times that a looping series has been replayed in full */
};

struct replay {
    struct source base;
    counter *samples, *up;
    /* --- below: the thread's own */
    struct replay_lane *lanes;
    size_t lane_count;
    int64_t start_mono_ns;
};

static bool stopping(const struct replay *replay, int64_t until_ns)
{
    return wait_for(-1, 0, replay->base.stop_fd, until_ns) == -ECANCELED;
}

static void read_lane(struct replay *replay, struct replay_lane *lane)
{
    const struct plant_tag *tag = &replay->base.plant->tags[lane->tag];
    char why[200];
    bool found;
    lane->change = tag->scale.change;
    if (series_read(&lane->series, replay->base.config->file, *tag->signal.address ? tag->signal.address : tag->name, &found, why) &&
        found) {
        const char *unit = lane->series.unit;
        if (!unit || !*unit || units_compare(unit, tag->unit, &lane->change) <= UNITS_CONVERT)
            return;
        snprintf(why, sizeof(why), "the unit '%.60s' in the replayed file cannot be converted to '%.60s'", unit, tag->unit);
        series_finish(&lane->series);
    }
    log_err(replay->base.log, "source %s: %s: %s", replay->base.config->id, tag->name, why);
    const struct sample none = { .tag = lane->tag, .quality = QUALITY_BAD_CONFIGURATION };
    store_write(replay->base.store, &none, 1, clock_mono_ns(), clock_utc_ns());
}

static int64_t due_ns(const struct replay *replay, const struct replay_lane *lane, size_t at)
{
    double time_s = lane->series.time_s[at] + (double)lane->rounds * lane->series.length_s;
    return replay->start_mono_ns + (int64_t)(time_s / replay->base.config->speed * 1e9);
}

static bool ended(const struct replay *replay, const struct replay_lane *lane)
{
    return lane->series.count == 0 || (!replay->base.config->loop && lane->next == lane->series.count);
}

/* Moves to the next sample of a series. A looping series starts again after its last sample. */
static void step(const struct replay *replay, struct replay_lane *lane)
{
    if (++lane->next < lane->series.count || !replay->base.config->loop)
        return;
    lane->next = 0;
    lane->rounds++;
}

static void play_lane(struct replay *replay, struct replay_lane *lane, int64_t now_mono_ns, int64_t now_utc_ns)
{
    for (int64_t due; !ended(replay, lane) && (due = due_ns(replay, lane, lane->next)) <= now_mono_ns; step(replay, lane)) {
        if (now_mono_ns - due > LATEST_NS)
            continue;
        double value = lane->series.value[lane->next];
        const struct plant_tag *tag = &replay->base.plant->tags[lane->tag];
        struct sample sample = { .tag = lane->tag,
                                 .value = unit_change_value(&lane->change, value),
                                 .quality = lane->series.quality[lane->next] };
        uint32_t own = isnan(value) ? QUALITY_BAD : decode_quality(tag, unit_change_back(&tag->scale.change, sample.value));
        if (quality_is_worse(own, sample.quality))
            sample.quality = own;
        store_write(replay->base.store, &sample, 1, due, now_utc_ns - (now_mono_ns - due));
        counter_inc(replay->samples, 1);
    }
}

static void set_up(struct replay *replay, bool up)
{
    counter_set(replay->up, up);
    if (up)
        store_link_up(replay->base.store, replay->base.index, clock_mono_ns());
    else
        store_link_lost(replay->base.store, replay->base.index, clock_mono_ns());
}

static bool all_ended(const struct replay *replay)
{
    for (size_t i = 0; i < replay->lane_count; i++)
        if (!ended(replay, &replay->lanes[i]))
            return false;
    return true;
}

static void replay_run(struct source *source)
{
    struct replay *replay = (struct replay *)source;
    for (size_t i = 0; i < replay->lane_count; i++) {
        if (stopping(replay, 0))
            return;
        read_lane(replay, &replay->lanes[i]);
    }
    if (all_ended(replay)) {
        set_up(replay, false);
        return;
    }
    set_up(replay, true);
    log_info(replay->base.log, "source %s: replaying the file %s at %g times its speed", replay->base.config->id, replay->base.config->file,
             replay->base.config->speed);
    replay->start_mono_ns = clock_mono_ns();
    do {
        int64_t mono_ns = clock_mono_ns(), utc_ns = clock_utc_ns();
        for (size_t i = 0; i < replay->lane_count; i++)
            play_lane(replay, &replay->lanes[i], mono_ns, utc_ns);
    } while (!all_ended(replay) && !stopping(replay, clock_mono_ns() + ROUND_NS));
    if (all_ended(replay)) {
        log_info(replay->base.log, "source %s: the replay of file %s has ended, so the source delivers no more readings",
                 replay->base.config->id, replay->base.config->file);
        set_up(replay, false);
    }
}

static void replay_destroy(struct source *source)
{
    struct replay *replay = (struct replay *)source;
    for (size_t i = 0; i < replay->lane_count; i++)
        series_finish(&replay->lanes[i].series);
    mem_free(replay->lanes);
    mem_free(replay);
}

static struct source *replay_create(const struct source *base, struct counters *counters)
{
    struct replay *replay = mem_new(sizeof(*replay));
    replay->base = *base;
    replay->samples = source_counter(base, counters, "samples_total", "", "counter",
                                     "Samples (readings) received from the source's server or broker, or replayed from its file.");
    replay->up =
        source_counter(base, counters, "up", "", "gauge", "1 while the source (connection to field devices, or replay) delivers readings.");
    replay->lanes = mem_array(base->plant->tag_count, sizeof(*replay->lanes));
    for (size_t i = 0; i < base->plant->tag_count; i++)
        if (base->plant->tags[i].source == base->index)
            replay->lanes[replay->lane_count++].tag = (int)i;
    return &replay->base;
}

const struct source_impl replay_impl = { .kind = "replay", .create = replay_create, .run = replay_run, .destroy = replay_destroy };
