/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cost of recording and querying history, in processor time and bytes on the disk; prints one JSON object per line. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/math/search.h"
#include "base/mem.h"
#include "history/historian.h"
#include "history/history.h"
#include "history/month.h"
#include "history/recorder.h"
#include "tests/support/plant_by_hand.h"
#include "tests/support/sleep.h"
#include "tests/support/temp.h"
#include "value/quality.h"

enum { TAGS = 20000, RATE_HZ = 5, SECONDS = 20, ASKED = 20, DAYS = 30, STEP_S = 30, ROUNDS = 5 };

static struct plant *make_plant(int count)
{
    struct plant *plant = plant_by_hand_create((size_t)count);
    plant->history.override_s = 600;
    plant_by_hand_source(plant, "plc", 502);
    for (int i = 0; i < count; i++) {
        char name[16];
        snprintf(name, sizeof(name), "T-%05d", i);
        plant_by_hand_tag(plant, name, TABLE_HOLDING, 0, DATA_FLOAT32)->deadband = 0.2;
    }
    return plant;
}

static double noise(void)
{
    return (double)rand() / RAND_MAX - 0.5;
}

/* Writes one sample of each tag to the store. Values drift at random by up to `wander` units per second and have noise, like
   those of transmitters. */
static void write_values(struct store *store, struct sample *samples, double wander, double noise_size)
{
    for (int i = 0; i < TAGS; i++) {
        samples[i].value += wander / RATE_HZ * noise();
        samples[i].tag = i;
    }
    struct sample *noisy = mem_array(TAGS, sizeof(*noisy));
    for (int i = 0; i < TAGS; i++)
        noisy[i] = (struct sample){ i, samples[i].value + noise_size * noise(), QUALITY_GOOD };
    store_write(store, noisy, TAGS, clock_mono_ns(), clock_utc_ns());
    mem_free(noisy);
}

static double counted(struct counters *counters, const char *name)
{
    return (double)*counters_add(counters, name, "counter", "");
}

/* Measures the cost of recording 100,000 values per second, from writing them to the store until they are on the disk. */
static void record(const char *name, double noise_size)
{
    char *folder = temp_folder();
    struct plant *plant = make_plant(TAGS);
    struct log *log = log_create(LOG_WARN);
    struct counters *counters = counters_create();
    struct store *store = store_create(plant);
    struct sample *samples = mem_array(TAGS, sizeof(*samples));
    const struct historian_params params = { .log = log, .counters = counters, .plant = plant, .store = store, .folder = folder };
    struct historian *historian = historian_start(&params);
    int64_t work_ns = clock_work_ns(), begin_ns = clock_mono_ns();
    for (int i = 0; i < SECONDS * RATE_HZ; i++) {
        write_values(store, samples, 0.2, noise_size);
        int64_t next_ns = begin_ns + (i + 1) * NS_PER_S / RATE_HZ, now_ns = clock_mono_ns();
        sleep_ns(next_ns > now_ns ? next_ns - now_ns : 0);
    }
    double took_s = (double)(clock_mono_ns() - begin_ns) / 1e9;
    historian_stop(&historian);
    double percent = 100 * (double)(clock_work_ns() - work_ns) / 1e9 / took_s;
    double in = counted(counters, "plantcast_history_samples_total"), lost = counted(counters, "plantcast_history_lost_total");
    printf("{\"name\": \"%s\", \"value\": %.1f, \"unit\": \"%%\", \"goal\": [\"<=\", 100], \"values_per_s\": %.0f, \"kept_percent\": %.1f,"
           " \"lost\": %.0f}\n", name, percent, in / took_s, 100 * counted(counters, "plantcast_history_points_total") / in, lost);
    fflush(stdout);
    mem_free(samples);
    store_destroy(&store);
    counters_destroy(&counters);
    log_destroy(&log);
}

/* --- disk of a plant ---------------------------------------------------------------------------------------------------------- */

enum { PLANT_TAGS = 186, PLANT_SOURCES = 4, PLANT_SECONDS = 7200, TIDY_S = 1200 };

/* Returns the number that /proc/self/io has under this name. */
static double process_io(const char *name)
{
    char line[80];
    double bytes = 0;
    FILE *file = fopen("/proc/self/io", "r");
    while (file && fgets(line, sizeof(line), file))
        if (!strncmp(line, name, strlen(name)))
            bytes = strtod(line + strlen(name), NULL);
    if (file)
        fclose(file);
    return bytes;
}

/* Records the two samples per tag of one second. They are like those of a PLC's transmitters: noisy, stored as 32-bit floats,
   and with one time stamp for all tags of a source. */
static void sample_second(struct recorder *recorder, int64_t t_us, double *values, struct recorder_rows *rows)
{
    for (int half = 0; half < 2; half++) {
        int64_t read_us[PLANT_SOURCES];
        for (int source = 0; source < PLANT_SOURCES; source++)
            read_us[source] = t_us + half * US_PER_S / 2 + source * 20000 + rand() % 3000;
        for (int tag = 0; tag < PLANT_TAGS; tag++) {
            values[tag] += 0.02 * noise();
            const struct history_point sample = { read_us[tag % PLANT_SOURCES], (float)(values[tag] + 0.35 * noise()), QUALITY_GOOD };
            recorder_put(recorder, tag, &sample, rows);
        }
    }
}

static double kept_bytes(struct log *log, const char *folder, int month)
{
    struct month_file_size size = { 0 };
    int error;
    struct month_file *file = month_file_read(log, folder, month, &error);
    if (file)
        month_file_size(file, &size);
    month_file_close(&file);
    return (double)(size.bytes - size.free_bytes);
}

/* Records two hours of a plant with 186 tags as the historian does, and counts the bytes that are kept, the bytes that the
   program writes, and those that the disk writes, in whole pages of 4096 bytes. */
static void measure_disk(struct log *log)
{
    char *folder = temp_folder();
    struct plant *plant = make_plant(PLANT_TAGS);
    struct history_tag *tags = history_tags(plant);
    struct recorder *recorder = recorder_create(plant, INT64_MIN);
    struct recorder_rows rows = { 0 }, held = { 0 };
    int64_t begin_us = INT64_C(1795200000) * US_PER_S;
    int month = month_of(begin_us), error;
    struct month_file *file = month_file_open(log, folder, month, tags, PLANT_TAGS, &error);
    double values[PLANT_TAGS] = { 0 }, recorded = 0, at_half = 0, written = process_io("wchar:"), stored = process_io("write_bytes:");
    for (int second = 0; second < PLANT_SECONDS; second++) {
        rows.count = held.count = 0;
        sample_second(recorder, begin_us + second * US_PER_S, values, &rows);
        recorder_held(recorder, &held);
        recorded += (double)rows.count;
        month_file_write(file, rows.at, rows.count, held.at, held.count);
        if (second % TIDY_S == TIDY_S - 1)
            month_file_tidy(file);
        if (second == PLANT_SECONDS / 2 - 1) /* kept bytes are counted from here on, to leave out the file's fixed size */
            at_half = kept_bytes(log, folder, month);
    }
    month_file_close(&file);
    double per_day = 86400.0 / PLANT_SECONDS / 1e9, kept = 2 * ((double)kept_bytes(log, folder, month) - at_half);
    written = process_io("wchar:") - written;
    stored = process_io("write_bytes:") - stored;
    printf("{\"name\": \"history_186_tags_kept_gb_per_day\", \"value\": %.3f, \"unit\": \"GB\", \"goal\": [\"<=\", 0.15],"
           " \"points_per_s\": %.0f, \"bytes_per_point\": %.2f}\n", kept * per_day, recorded / PLANT_SECONDS, kept / recorded);
    printf("{\"name\": \"history_186_tags_written_gb_per_day\", \"value\": %.3f, \"unit\": \"GB\", \"goal\": [\"<=\", 0.6],"
           " \"bytes_per_point\": %.2f, \"in_pages_gb_per_day\": %.3f}\n", written * per_day, written / recorded, stored * per_day);
    fflush(stdout);
    mem_free(rows.at);
    mem_free(held.at);
    recorder_destroy(&recorder);
    mem_free(tags);
}

/* Writes DAYS days of samples to the history. Consecutive samples differ by more than the deadband, so that none is dropped.
   Also writes the summaries of every minute (rollups). */
static void fill(struct log *log, const char *folder, const struct history_tag *tags, int64_t end_us)
{
    size_t count = DAYS * 86400 / STEP_S;
    struct history_point *points = mem_array(count, sizeof(*points));
    int64_t begin_us = end_us - DAYS * 86400 * US_PER_S;
    for (int tag = 0; tag < ASKED; tag++) {
        for (size_t i = 0; i < count; i++)
            points[i] = (struct history_point){ begin_us + (int64_t)i * STEP_S * US_PER_S, 100 * noise(), QUALITY_GOOD };
        for (size_t i = 0, end; i < count; i = end) {
            int month = month_of(points[i].t_us), error;
            for (end = i; end < count && month_of(points[end].t_us) == month;)
                end++;
            struct month_file *file = month_file_open(log, folder, month, tags, ASKED, &error);
            month_file_import(file, tag, points + i, end - i);
            month_file_close(&file);
        }
    }
    mem_free(points);
}

static void ask(struct log *log, const char *folder, const struct history_tag *tags, int64_t end_us, int points)
{
    double ms[ROUNDS];
    size_t found = 0;
    for (int round = 0; round < ROUNDS; round++) {
        struct history_reader *reader = history_reader_create(log, folder);
        int64_t begin_ns = clock_mono_ns();
        found = 0;
        for (int tag = 0; tag < ASKED; tag++) {
            struct history_series series;
            history_series(reader, tags[tag].name, end_us - DAYS * 86400 * US_PER_S, end_us, points, &series);
            found += series.points.count + series.buckets.count;
            history_series_finish(&series);
        }
        ms[round] = (double)(clock_mono_ns() - begin_ns) / 1e6;
        history_reader_destroy(&reader);
    }
    qsort(ms, ROUNDS, sizeof(*ms), compare_doubles);
    printf("{\"name\": \"history_20_tags_30_days_%d_points_ms\", \"value\": %.1f, \"unit\": \"ms\", \"goal\": [\"<=\", 200], \"p95\": %.1f,"
           " \"points\": %zu}\n", points, ms[ROUNDS / 2], ms[ROUNDS - 1], found);
    fflush(stdout);
}

static void look_back(struct log *log, const char *folder, const struct history_tag *tags, int64_t end_us)
{
    struct history_reader *reader = history_reader_create(log, folder);
    struct snapshot *snapshot = snapshot_create(ASKED);
    double ms[50];
    for (int i = 0; i < 50; i++) {
        int64_t begin_ns = clock_mono_ns();
        history_at(reader, tags, end_us - (int64_t)((noise() + 0.5) * DAYS * 86400 * 1e6), snapshot);
        ms[i] = (double)(clock_mono_ns() - begin_ns) / 1e6;
    }
    qsort(ms, 50, sizeof(*ms), compare_doubles);
    printf("{\"name\": \"history_instant_20_tags_ms\", \"value\": %.2f, \"unit\": \"ms\", \"p95\": %.2f}\n", ms[25], ms[47]);
    snapshot_destroy(&snapshot);
    history_reader_destroy(&reader);
}

int main(void)
{
    record("history_100k_values_percent_of_core", 0.1);
    record("history_100k_noisy_values_percent_of_core", 10);
    struct log *log = log_create(LOG_WARN);
    measure_disk(log);
    char *folder = temp_folder();
    struct plant *plant = make_plant(ASKED);
    struct history_tag *tags = history_tags(plant);
    int64_t end_us = INT64_C(1795200000) * US_PER_S;
    fill(log, folder, tags, end_us);
    ask(log, folder, tags, end_us, 1000);
    ask(log, folder, tags, end_us, 2000);
    look_back(log, folder, tags, end_us);
    log_destroy(&log);
    mem_free(tags);
    return 0;
}
