/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cost of alarms, printed as one JSON line per row: 20,000 tags with four limits each, scanned once per second, and a journal
   of a whole year. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "alarm/alarms.h"
#include "alarm/journal_file.h"
#include "base/clock.h"
#include "base/math/search.h"
#include "base/mem.h"
#include "tests/support/plant_by_hand.h"
#include "tests/support/temp.h"
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
        memcpy(plant_by_hand_tag(plant, name, TABLE_HOLDING, 0, DATA_FLOAT32)->alarms.limits, limits, sizeof(limits));
    }
    return plant;
}

static void count(void *arg, const struct alarm_change *change)
{
    (void)change;
    ++*(int *)arg;
}

struct alarm_bench {
    struct alarms *alarms;
    struct sample_event *events;
    struct snapshot *snapshot;
    int64_t second_ns; /* simulated time, in ns, at which the next simulated second begins */
    int changes;
};

/* Simulates one second of the daemon: one scan of all tags and ten clock ticks. Returns the milliseconds of work. */
static double second(struct alarm_bench *bench)
{
    int64_t begun_ns = clock_work_ns();
    for (int i = 0; i < TAGS; i++) {
        bench->events[i].mono_ns = bench->events[i].utc_ns = bench->second_ns;
        bench->snapshot->readings[i] = (struct reading){ .value = bench->events[i].value };
    }
    alarms_put(bench->alarms, bench->events, TAGS);
    for (int i = 0; i < 10; i++) {
        bench->snapshot->taken_mono_ns = bench->snapshot->taken_utc_ns = bench->second_ns + i * NS_PER_S / 10;
        alarms_tick(bench->alarms, bench->snapshot);
    }
    bench->second_ns += NS_PER_S;
    return (double)(clock_work_ns() - begun_ns) / 1e6;
}

/* Simulates an alarm flood: in each second FLOOD_HZ tags exceed a limit, and those of the second before return within their
   limits. Returns the work for the worst second, in milliseconds. */
static double flood(struct alarm_bench *bench)
{
    double worst_ms = 0;
    for (int s = 0; s < SECONDS; s++) {
        for (int i = 0; i < FLOOD_HZ; i++) {
            bench->events[(FLOOD_HZ * s + i) % TAGS].value = 85;
            bench->events[(FLOOD_HZ * (s + TAGS - 1) + i) % TAGS].value = 50;
        }
        double ms = second(bench);
        worst_ms = ms > worst_ms ? ms : worst_ms;
    }
    return worst_ms;
}

static double burst(struct alarm_bench *bench)
{
    for (int i = 0; i < TAGS; i++)
        bench->events[i].value = i < BURST ? 95 : 50;
    double ms = second(bench);
    for (int i = 0; i < BURST; i++)
        bench->events[i].value = 50;
    second(bench);
    return ms;
}

static void row(const char *name, double value, double goal)
{
    printf("{\"name\": \"%s\", \"value\": %.3f, \"unit\": \"ms\", \"goal\": [\"<=\", %g]}\n", name, value, goal);
}

enum { YEAR_S = 365 * 86400, KEPT = 300000, KEPT_ALARMS = 2000, INSTANTS = 21 };

/* Fills a journal with KEPT changes of 2,000 alarms, spread over a year: more than 800 changes per day. */
static bool fill_journal(struct journal_file *file)
{
    struct journal_entry *entries = mem_array(KEPT, sizeof(*entries));
    for (int i = 0; i < KEPT; i++) {
        int alarm = (int)((i * INT64_C(7919)) % KEPT_ALARMS);
        bool raised = i / KEPT_ALARMS % 2 == 0;
        entries[i] = (struct journal_entry){ .alarm = { .kind = ALARM_H, .priority = 3, .state.active = raised },
                                             .changed = true,
                                             .event = raised ? ALARM_RAISE : ALARM_CLEAR,
                                             .after = raised ? ALARM_ACTIVE : ALARM_NORMAL,
                                             .utc_ns = i * (YEAR_S * NS_PER_S / KEPT) };
        snprintf(entries[i].tag, sizeof(entries[i].tag), "T-%05d", alarm);
    }
    bool good = journal_file_write(file, entries, KEPT) == 0;
    mem_free(entries);
    return good;
}

static void count_row(void *arg, const struct journal_row *r)
{
    (void)r;
    ++*(int *)arg;
}

/* Measures two queries of the journal for instants in the past: the states of all alarms at the instant, and the page of rows
   before it. */
static bool look_back(void)
{
    char *folder = temp_folder();
    struct log *log = log_create(LOG_WARN);
    bool renewed, good;
    int error, found = 0;
    double at_ms[INSTANTS], page_ms[INSTANTS];
    struct journal_file *file = journal_file_open(log, folder, &renewed, &error);
    good = file && fill_journal(file);
    for (int i = 0; good && i < INSTANTS; i++) {
        int64_t t_us = (int64_t)(i + 1) * YEAR_S / INSTANTS * 1000000, begun_ns = clock_work_ns();
        good = journal_file_at(file, t_us, count_row, &found) == 0;
        at_ms[i] = (double)(clock_work_ns() - begun_ns) / 1e6;
        const struct journal_query query = { INT64_MIN, t_us, INT64_MAX, NULL, 1000 };
        begun_ns = clock_work_ns();
        good = good && journal_file_rows(file, &query, count_row, &found) == 0;
        page_ms[i] = (double)(clock_work_ns() - begun_ns) / 1e6;
    }
    qsort(at_ms, INSTANTS, sizeof(*at_ms), compare_doubles);
    qsort(page_ms, INSTANTS, sizeof(*page_ms), compare_doubles);
    if (good) {
        row("alarms_then_in_a_year_ms", at_ms[INSTANTS / 2], 50);
        row("alarms_journal_page_of_a_year_ms", page_ms[INSTANTS / 2], 50);
    }
    journal_file_close(&file);
    log_destroy(&log);
    return good && found > INSTANTS * 1000;
}

int main(void)
{
    struct plant *plant = make_plant();
    struct alarm_bench bench = { .second_ns = 1000 * NS_PER_S };
    bench.alarms = alarms_create(plant, &(struct alarms_listener){ .changed = count, .arg = &bench.changes });
    bench.events = mem_array(TAGS, sizeof(*bench.events));
    bench.snapshot = snapshot_create(TAGS);
    for (int i = 0; i < TAGS; i++)
        bench.events[i] = (struct sample_event){ .tag = i, .value = 50, .quality = QUALITY_GOOD };
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
    mem_free(bench.events);
    alarms_destroy(&bench.alarms);
    return look_back() ? 0 : 1;
}
