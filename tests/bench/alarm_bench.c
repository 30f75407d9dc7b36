/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cost of alarms: one JSON line per row. 20,000 tags with four limits each, scanned once a second. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "alarm/alarms.h"
#include "base/clock.h"
#include "base/mem.h"
#include "tests/support/plant_by_hand.h"
#include "value/quality.h"

enum { TAGS = 20000, SECONDS = 60, FLOOD_HZ = 10, BURST = 1000, ROUNDS = 5 };

static struct plant *make_plant(void)
{
    static const double limits[LIMIT_COUNT] = { 0, 10, 80, 90 };
    struct plant *plant = plant_by_hand_create(TAGS);
    plant->alarms = ALARMS_LOCAL;
    plant_by_hand_source(plant, "plc", 502);
    for (int i = 0; i < TAGS; i++) {
        char name[16];
        snprintf(name, sizeof(name), "T-%05d", i);
        memcpy(plant_by_hand_tag(plant, name, TABLE_HOLDING, 0, DATA_FLOAT32)->limits, limits, sizeof(limits));
    }
    return plant;
}

static void count(void *arg, const struct alarm_change *change)
{
    (void)change;
    ++*(int *)arg;
}

struct bench {
    struct alarms *alarms;
    struct heard *heard;
    struct snapshot *snapshot;
    int64_t second_ns; /* of the plant */
    int changes;
};

/* One scan of all tags and ten looks at the clock, as in a second of the daemon's life. Milliseconds of work. */
static double second(struct bench *bench)
{
    int64_t begun_ns = clock_work_ns();
    for (int i = 0; i < TAGS; i++) {
        bench->heard[i].mono_ns = bench->heard[i].utc_ns = bench->second_ns;
        bench->snapshot->readings[i] = (struct reading){ .value = bench->heard[i].value };
    }
    alarms_hear(bench->alarms, bench->heard, TAGS);
    for (int i = 0; i < 10; i++) {
        bench->snapshot->taken_mono_ns = bench->snapshot->taken_utc_ns = bench->second_ns + i * NS_PER_S / 10;
        alarms_tick(bench->alarms, bench->snapshot);
    }
    bench->second_ns += NS_PER_S;
    return (double)(clock_work_ns() - begun_ns) / 1e6;
}

/* FLOOD_HZ tags a second go beyond their limit, and those before them come back. */
static double flood(struct bench *bench)
{
    double worst_ms = 0;
    for (int s = 0; s < SECONDS; s++) {
        for (int i = 0; i < FLOOD_HZ; i++) {
            bench->heard[(FLOOD_HZ * s + i) % TAGS].value = 85;
            bench->heard[(FLOOD_HZ * (s + TAGS - 1) + i) % TAGS].value = 50;
        }
        double ms = second(bench);
        worst_ms = ms > worst_ms ? ms : worst_ms;
    }
    return worst_ms;
}

static double burst(struct bench *bench)
{
    for (int i = 0; i < TAGS; i++)
        bench->heard[i].value = i < BURST ? 95 : 50;
    double ms = second(bench);
    for (int i = 0; i < BURST; i++)
        bench->heard[i].value = 50;
    second(bench);
    return ms;
}

static void row(const char *name, double value, double goal)
{
    printf("{\"name\": \"%s\", \"value\": %.3f, \"unit\": \"ms\", \"goal\": %g, \"ok\": %s}\n", name, value, goal,
           value <= goal ? "true" : "false");
}

int main(void)
{
    struct plant *plant = make_plant();
    struct bench bench = { .second_ns = 1000 * NS_PER_S };
    bench.alarms = alarms_create(plant, &(struct alarms_listener){ .changed = count, .arg = &bench.changes });
    bench.heard = mem_array(TAGS, sizeof(*bench.heard));
    bench.snapshot = snapshot_create(TAGS);
    for (int i = 0; i < TAGS; i++)
        bench.heard[i] = (struct heard){ .tag = i, .value = 50, .quality = QUALITY_GOOD };
    second(&bench);
    double flood_ms = flood(&bench), burst_ms = 1e9;
    for (int i = 0; i < ROUNDS; i++) {
        double ms = burst(&bench);
        burst_ms = ms < burst_ms ? ms : burst_ms;
    }
    if (bench.changes < SECONDS * FLOOD_HZ + ROUNDS * 2 * BURST)
        return 1;
    row("alarms_20000_flood_second_ms", flood_ms, 100);
    row("alarms_20000_burst_1000_ms", burst_ms, 100);
    snapshot_destroy(&bench.snapshot);
    mem_free(bench.heard);
    alarms_destroy(&bench.alarms);
    plant_by_hand_destroy(&plant);
    return 0;
}
