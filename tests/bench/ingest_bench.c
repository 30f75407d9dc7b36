/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures how old the oldest readings get while the daemon polls ten Modbus devices with 2,000 tags each, all read once per
   second. One device does not answer, and one answers slowly. Prints one JSON line per measured quantity. */
#include <stdio.h>
#include <stdlib.h>

#include "base/clock.h"
#include "base/math/search.h"
#include "base/mem.h"
#include "tests/support/modbus_device.h"
#include "tests/support/plant_by_hand.h"
#include "tests/support/sleep.h"
#include "value/quality.h"
#include "value/source.h"

enum { DEVICES = 10, TAGS = 2000, DEAD = 3, SLOW = 7, SLOW_MS = 30, WARM_S = 3, SECONDS = 10, LOOKS = SECONDS * 10 };

static struct plant *make_plant(const struct modbus_device *devices)
{
    struct plant *plant = plant_by_hand_create(DEVICES * TAGS);
    for (int d = 0; d < DEVICES; d++) {
        char name[24];
        snprintf(name, sizeof(name), "plc%d", d);
        struct plant_source *source = plant_by_hand_source(plant, name, devices[d].port);
        source->poll_ms = 1000;
        source->timeout_ms = 1000;
        for (int i = 0; i < TAGS; i++) {
            snprintf(name, sizeof(name), "T%d-%04d", d, i);
            plant_by_hand_tag(plant, name, TABLE_HOLDING, i, DATA_INT16);
        }
    }
    return plant;
}

/* Returns the age in milliseconds of the oldest reading of a device in the snapshot. Adds to *wrong the number of its readings
   that are not Good or differ from the device's values. */
static double oldest_ms(const struct snapshot *snapshot, int device, long *wrong)
{
    double oldest = 0;
    for (int i = 0; i < TAGS; i++) {
        const struct reading *reading = &snapshot->readings[device * TAGS + i];
        double age_ms = (double)reading->age_ns / 1e6;
        oldest = age_ms > oldest ? age_ms : oldest;
        *wrong += reading->quality != QUALITY_GOOD || reading->value != i;
    }
    return oldest;
}

static void print_row(const char *name, double *values, int count, double goal, const char *more, long number)
{
    qsort(values, (size_t)count, sizeof(*values), compare_doubles);
    printf("{\"name\": \"%s\", \"value\": %.0f, \"unit\": \"ms\", \"goal\": [\"<=\", %.0f], \"p95\": %.0f, \"%s\": %ld}\n", name,
           values[count / 2], goal, values[count * 95 / 100], more, number);
    fflush(stdout);
}

static void watch(struct store *store)
{
    struct snapshot *snapshot = snapshot_create(DEVICES * TAGS);
    double *good = mem_array(LOOKS * DEVICES, sizeof(*good)), *slow = mem_array(LOOKS, sizeof(*slow));
    int good_count = 0;
    long wrong = 0, slow_wrong = 0, dead_wrong = 0;
    int64_t work_ns = clock_work_ns(), begin_ns = clock_mono_ns();
    for (int look = 0; look < LOOKS; look++) {
        sleep_ns(begin_ns + (look + 1) * 100 * NS_PER_MS - clock_mono_ns());
        store_snapshot(store, clock_mono_ns(), clock_utc_ns(), snapshot);
        for (int d = 0; d < DEVICES; d++)
            if (d != DEAD && d != SLOW)
                good[good_count++] = oldest_ms(snapshot, d, &wrong);
        slow[look] = oldest_ms(snapshot, SLOW, &slow_wrong);
        for (int i = 0; i < TAGS; i++)
            dead_wrong += !quality_is_bad(snapshot->readings[DEAD * TAGS + i].quality);
    }
    double percent = 100 * (double)(clock_work_ns() - work_ns) / (double)(clock_mono_ns() - begin_ns);
    print_row("ingest_10x2000_oldest_ms", good, good_count, 1500, "not_good", wrong);
    print_row("ingest_10x2000_oldest_of_slow_ms", slow, LOOKS, 2000, "not_good", slow_wrong);
    printf("{\"name\": \"ingest_10x2000_percent_of_core\", \"value\": %.1f, \"unit\": \"%%\", \"goal\": [\"<=\", 100],"
           " \"dead_that_look_alive\": %ld, \"with\": \"the devices themselves\"}\n", percent, dead_wrong);
    mem_free(good);
    mem_free(slow);
    snapshot_destroy(&snapshot);
}

int main(void)
{
    static struct modbus_device devices[DEVICES];
    struct source *sources[DEVICES];
    struct log *log = log_create(LOG_ERROR);
    struct counters *counters = counters_create();
    devices[DEAD].manner = DEVICE_SILENT;
    devices[SLOW].manner = DEVICE_LATE;
    devices[SLOW].late_ms = SLOW_MS;
    for (int d = 0; d < DEVICES; d++)
        device_start(&devices[d]);
    struct plant *plant = make_plant(devices);
    struct store *store = store_create(plant);
    for (int d = 0; d < DEVICES; d++)
        sources[d] = source_start(log, plant, d, store, counters);
    sleep_ns(WARM_S * NS_PER_S);
    watch(store);
    for (int d = 0; d < DEVICES; d++)
        source_stop(&sources[d]);
    for (int d = 0; d < DEVICES; d++)
        device_stop(&devices[d]);
    store_destroy(&store);
    counters_destroy(&counters);
    log_destroy(&log);
    return 0;
}
