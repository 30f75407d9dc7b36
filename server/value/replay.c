/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recorded series, given to the store when their times have come. */
#include "value/source_impl.h"

#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/mem.h"
#include "value/lookup.h"
#include "value/quality.h"
#include "value/series.h"

static const int64_t ROUND_NS = 50 * NS_PER_MS;
static const int64_t LATEST_NS = 10 * NS_PER_S; /* after a sleep of the machine, what is older is passed over */

struct lane { /* a tag and its series */
    int tag;
    struct unit_change change; /* of its values to readings */
    struct series series; /* count 0: there is none */
    size_t next;
    int64_t rounds;       /* of a loop */
};

struct replay {
    struct source base;
    struct log *log;
    const struct plant *plant;
    const struct plant_source *config;
    int index;
    struct store *store;
    counter *samples, *up;
    int stop_fd;
    pthread_t thread;
    bool has_thread;
    /* --- below: the thread's own */
    struct lane *lanes;
    size_t lane_count;
    int64_t start_mono_ns;
};

static bool stopping(const struct replay *replay, int64_t until_ns)
{
    return wait_for(-1, 0, replay->stop_fd, until_ns) == -ECANCELED;
}

static void read_lane(struct replay *replay, struct lane *lane)
{
    const struct plant_tag *tag = &replay->plant->tags[lane->tag];
    char why[200];
    bool found;
    lane->change = tag->change;
    if (series_read(&lane->series, replay->config->file, *tag->address ? tag->address : tag->name, &found, why) && found) {
        const char *unit = lane->series.unit;
        if (!unit || !*unit || units_compare(unit, tag->unit, &lane->change) <= UNITS_CONVERT)
            return;
        snprintf(why, sizeof(why), "'%.60s', as the file says, cannot be converted to '%.60s'", unit, tag->unit);
        series_finish(&lane->series);
    }
    log_err(replay->log, "source %s: %s: %s", replay->config->id, tag->name, why);
    const struct sample none = { .tag = lane->tag, .quality = QUALITY_BAD_CONFIGURATION };
    store_write(replay->store, &none, 1, clock_mono_ns(), clock_utc_ns());
}

static int64_t due_ns(const struct replay *replay, const struct lane *lane, size_t at)
{
    double time_s = lane->series.time_s[at] + (double)lane->rounds * lane->series.length_s;
    return replay->start_mono_ns + (int64_t)(time_s / replay->config->speed * 1e9);
}

static bool ended(const struct replay *replay, const struct lane *lane)
{
    return lane->series.count == 0 || (!replay->config->loop && lane->next == lane->series.count);
}

/* Moves on; after the last comes the first. */
static void step(const struct replay *replay, struct lane *lane)
{
    if (++lane->next < lane->series.count || !replay->config->loop)
        return;
    lane->next = 0;
    lane->rounds++;
}

static void play_lane(struct replay *replay, struct lane *lane, int64_t now_mono_ns, int64_t now_utc_ns)
{
    for (int64_t due; !ended(replay, lane) && (due = due_ns(replay, lane, lane->next)) <= now_mono_ns; step(replay, lane)) {
        if (now_mono_ns - due > LATEST_NS)
            continue;
        const struct sample sample = { .tag = lane->tag, .value = unit_change_value(&lane->change, lane->series.value[lane->next]) };
        store_write(replay->store, &sample, 1, due, now_utc_ns - (now_mono_ns - due));
        counter_inc(replay->samples, 1);
    }
}

static void set_up(struct replay *replay, bool up)
{
    counter_set(replay->up, up);
    if (up)
        store_link_up(replay->store, replay->index, clock_mono_ns());
    else
        store_link_lost(replay->store, replay->index, clock_mono_ns());
}

static bool all_ended(const struct replay *replay)
{
    for (size_t i = 0; i < replay->lane_count; i++)
        if (!ended(replay, &replay->lanes[i]))
            return false;
    return true;
}

static void *replay_main(void *arg)
{
    struct replay *replay = arg;
    for (size_t i = 0; i < replay->lane_count; i++) {
        if (stopping(replay, 0))
            return NULL;
        read_lane(replay, &replay->lanes[i]);
    }
    if (all_ended(replay)) {
        set_up(replay, false);
        return NULL;
    }
    set_up(replay, true);
    log_info(replay->log, "source %s: replays %s at %g times its speed", replay->config->id, replay->config->file, replay->config->speed);
    replay->start_mono_ns = clock_mono_ns();
    do {
        int64_t mono_ns = clock_mono_ns(), utc_ns = clock_utc_ns();
        for (size_t i = 0; i < replay->lane_count; i++)
            play_lane(replay, &replay->lanes[i], mono_ns, utc_ns);
    } while (!all_ended(replay) && !stopping(replay, clock_mono_ns() + ROUND_NS));
    if (all_ended(replay)) {
        log_info(replay->log, "source %s: %s has ended", replay->config->id, replay->config->file);
        set_up(replay, false);
    }
    return NULL;
}

static void replay_stop(struct source *source)
{
    struct replay *replay = (struct replay *)source;
    if (replay->has_thread) {
        eventfd_write(replay->stop_fd, 1);
        pthread_join(replay->thread, NULL);
    }
    if (replay->stop_fd >= 0)
        close(replay->stop_fd);
    for (size_t i = 0; i < replay->lane_count; i++)
        series_finish(&replay->lanes[i].series);
    mem_free(replay->lanes);
    mem_free(replay);
}

static counter *add_counter(struct counters *counters, const char *format, const char *id, const char *type, const char *help)
{
    char *name = mem_printf("plantcast_source_%s{source=\"%s\"}", format, id);
    counter *added = counters_add(counters, name, type, help);
    mem_free(name);
    return added;
}

static struct source *replay_start(struct log *log, const struct plant *plant, int source, struct store *store, struct counters *counters)
{
    struct replay *replay = mem_new(sizeof(*replay));
    *replay = (struct replay){
        .base.impl = &replay_impl, .log = log, .plant = plant, .config = &plant->sources[source], .index = source, .store = store
    };
    replay->samples = add_counter(counters, "samples_total", replay->config->id, "counter", "samples given by replays and brokers");
    replay->up = add_counter(counters, "up", replay->config->id, "gauge", "1 while readings come in");
    replay->lanes = mem_array(plant->tag_count, sizeof(*replay->lanes));
    for (size_t i = 0; i < plant->tag_count; i++)
        if (plant->tags[i].source == source)
            replay->lanes[replay->lane_count++].tag = (int)i;
    replay->stop_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    replay->has_thread = replay->stop_fd >= 0 && pthread_create(&replay->thread, NULL, replay_main, replay) == 0;
    if (replay->has_thread)
        return &replay->base;
    log_err(log, "source %s: no thread: %s", replay->config->id, strerror(errno));
    replay_stop(&replay->base);
    return NULL;
}

const struct source_impl replay_impl = { .kind = "replay", .start = replay_start, .stop = replay_stop };
