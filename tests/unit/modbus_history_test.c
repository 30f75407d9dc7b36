/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A recorded series is sent sixty times as fast through Modbus into the history and compared with what the history returns:
   spikes, gaps and quality. REPLAY_S sets the seconds; `make test-long` runs an hour. */
#include "tests/support/test.h"
#include <pthread.h>
#include <stdatomic.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "base/clock.h"
#include "deploy/demo/sim.h"
#include "history/historian.h"
#include "history/history.h"
#include "tests/support/modbus_device.h"
#include "tests/support/ports.h"
#include "tests/support/sleep.h"
#include "value/quality.h"
#include "value/source.h"

enum { SPEED = 60, TICK_MS = 50, SHORT_S = 8, OUTAGE_MS = 1500, SPIKE_MS = 400, MOST_POINTS = 1000000 };
static const char plant_path[] = "tests/plants/cookie_line.yaml", map_path[] = "tests/plants/cookie_line.map";
static const char data_path[] = "../shared/data/sensors/cookie_factory/telemetry.csv";

/* a growing array of values with time and quality: what a device's registers held, or the readings that the store got from them
   */
struct register_rows {
    struct register_row {
        int64_t mono_ns, utc_ns;
        double value;
        uint32_t quality;
    } * at;
    size_t count, capacity;
};

struct modbus_replay {
    struct plant *plant;
    struct sim_values *values;
    struct sim sim;
    int port, stop_fd;
    _Atomic bool deaf;        /* the device does not answer */
    _Atomic int spike;        /* tag whose value the simulated device replaces with a spike; -1: none */
    struct register_rows *held, *told; /* by tag */
    size_t *mapped, mapped_count;
};

static void add_row(struct register_rows *rows, int64_t mono_ns, int64_t utc_ns, double value, uint32_t quality)
{
    mem_grow(&rows->at, &rows->capacity, rows->count + 1, sizeof(*rows->at));
    rows->at[rows->count++] = (struct register_row){ mono_ns, utc_ns, value, quality };
}

static void on_sample_event(void *arg, const struct sample_event *event)
{
    struct modbus_replay *r = arg;
    add_row(&r->told[event->tag], event->mono_ns, event->utc_ns, event->value, event->quality);
}

static void *device_main(void *arg)
{
    struct modbus_replay *r = arg;
    struct sim_port port;
    int64_t last_ns = clock_mono_ns();
    bool done = sim_port_open(&port, "127.0.0.1", r->port, sim_modbus_take, &r->sim.devices[0].modbus) != 0;
    while (!done) {
        int64_t now_ns = clock_mono_ns();
        int spike = r->spike;
        sim_values_step(r->values, (double)(now_ns - last_ns) / 1e9 * SPEED);
        if (spike >= 0)
            sim_values_force(r->values, (size_t)spike, 1000);
        for (size_t i = 0; spike < 0 && i < r->mapped_count; i++)
            sim_values_release(r->values, r->mapped[i]);
        sim_update(&r->sim);
        for (size_t i = 0; i < r->mapped_count; i++)
            add_row(&r->held[r->mapped[i]], now_ns, 0, (double)(float)sim_values_at(r->values, r->mapped[i]), QUALITY_GOOD);
        last_ns = now_ns;
        done = r->deaf ? sleep_ns(TICK_MS * NS_PER_MS), false : sim_ports_serve(&port, 1, r->stop_fd, TICK_MS);
    }
    sim_port_close(&port);
    return NULL;
}

/* Asserts that each good reading in the store has a value that the register held when it was read: the newest one then, or one
   that changed during the request. */
static void check_wire(const struct modbus_replay *r, size_t tag)
{
    const struct register_rows *held = &r->held[tag], *told = &r->told[tag];
    const struct plant_tag *t = &r->plant->tags[tag];
    /* `within`: allowed error of a reading, half a raw step for integer types */
    double step =
        t->scale.kind == SCALING_NONE ? 1 : (t->scale.scaled_high - t->scale.scaled_low) / (t->scale.raw_high - t->scale.raw_low);
    double within = t->signal.type == DATA_FLOAT32 ? 0 : 0.501 * step;
    size_t from = 0, good = 0;
    for (size_t i = 0; i < told->count; i++) {
        const struct register_row *row = &told->at[i];
        if (quality_is_bad(row->quality) || row->quality == QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE)
            continue;
        while (from + 1 < held->count && held->at[from + 1].mono_ns < row->mono_ns - 2 * NS_PER_S)
            from++;
        bool found = false;
        for (size_t k = from; !found && k < held->count && held->at[k].mono_ns <= row->mono_ns; k++)
            found = fabs(held->at[k].value - row->value) <= within;
        if (!found)
            print_message("# %s: %.9g was never in its register\n", r->plant->tags[tag].name, row->value);
        assert_true(found);
        good++;
    }
    assert_true(good > 20);
}

/* Returns the value that the history's line has at t_us; *quality: the quality of the last point before. */
static double line_at(const struct history_series *series, int64_t t_us, uint32_t *quality)
{
    const struct history_points *points = &series->points;
    size_t k = 0;
    while (k + 1 < points->count && points->at[k + 1].t_us <= t_us)
        k++;
    const struct history_point *a = &points->at[k], *b = k + 1 < points->count ? a + 1 : a;
    *quality = a->quality;
    if (b == a || a->t_us == b->t_us || quality_is_bad(b->quality))
        return a->value;
    return a->value + (b->value - a->value) * (double)(t_us - a->t_us) / (double)(b->t_us - a->t_us);
}

/* Compares each reading of the store with the history at its time: the value must be within the tag's deviation, and the
   quality must be the same. */
static void check_history(const struct modbus_replay *r, struct history_reader *reader, const struct history_tag *tag, size_t index,
                          double *worst)
{
    const struct register_rows *told = &r->told[index];
    struct history_series series;
    bool gap = false;
    double most = -INFINITY;
    int64_t first_us = told->at[0].utc_ns / 1000, last_us = told->at[told->count - 1].utc_ns / 1000;
    assert_int_equal(history_series(reader, tag->name, first_us, last_us + 1, MOST_POINTS, &series), 0);
    assert_true(series.bucket_us == 0 && series.points.count > 0);
    for (size_t i = 0; i < told->count; i++) {
        uint32_t quality;
        double value = line_at(&series, told->at[i].utc_ns / 1000, &quality);
        assert_string_equal(quality_name(quality), quality_name(told->at[i].quality));
        gap |= told->at[i].quality == QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE;
        if (quality_is_bad(quality))
            continue;
        most = fmax(most, value);
        *worst = fmax(*worst, fabs(value - told->at[i].value) / tag->within);
        if (!(fabs(value - told->at[i].value) <= tag->within * 1.0001 + 1e-6))
            print_message("# %s: %.9g instead of %.9g after %.3f s (deviation %.3g)\n", tag->name, value, told->at[i].value,
                          (double)(told->at[i].utc_ns - told->at[0].utc_ns) / 1e9, tag->within);
        assert_true(fabs(value - told->at[i].value) <= tag->within * 1.0001 + 1e-6);
    }
    assert_true(gap);
    /* the history has the spike that this test put into the first tag, with its full height of 1000 */
    assert_true(index != r->mapped[0] || fabs(most - 1000) <= tag->within);
    history_series_finish(&series);
}

/* Lets the device answer no requests until no mapped tag in the store has a good reading. Then it answers again. The test fails
   if a tag still has a good reading after 30 s. */
static void outage(struct modbus_replay *r, struct store *store)
{
    struct snapshot *snapshot = test_snapshot(r->plant->tag_count);
    size_t lost = 0;
    r->deaf = true;
    sleep_ns(OUTAGE_MS * NS_PER_MS);
    for (int64_t end_ns = clock_mono_ns() + 30 * NS_PER_S; lost < r->mapped_count && clock_mono_ns() < end_ns; sleep_ns(10 * NS_PER_MS)) {
        store_snapshot(store, clock_mono_ns(), clock_utc_ns(), snapshot);
        lost = 0;
        for (size_t i = 0; i < r->mapped_count; i++)
            lost += !quality_is_good(snapshot->readings[r->mapped[i]].quality);
    }
    assert_int_equal(lost, r->mapped_count);
    r->deaf = false;
}

static void run(struct modbus_replay *r, struct store *store, double seconds)
{
    int64_t ms = (int64_t)(seconds * 1000);
    sleep_ns((ms / 4) * NS_PER_MS);
    r->spike = (int)r->mapped[0];
    sleep_ns(SPIKE_MS * NS_PER_MS);
    r->spike = -1;
    sleep_ns((ms / 4) * NS_PER_MS);
    outage(r, store);
    sleep_ns((ms / 2) * NS_PER_MS);
}

static void make_plant(struct modbus_replay *r)
{
    struct diag diag = { 0 };
    struct sim_map map = { 0 };
    r->plant = plant_load(plant_path, &diag);
    assert_non_null(r->plant);
    sim_map_read(&map, map_path, &diag);
    r->values = sim_values_create(r->plant, &map, true, &diag);
    assert_non_null(r->values);
    r->mapped = mem_array(map.count, sizeof(*r->mapped));
    for (size_t i = 0; i < map.count; i++)
        r->mapped[r->mapped_count++] = (size_t)plant_find_tag(r->plant, map.entries[i].tag);
    sim_map_finish(&map);
    diag_finish(&diag);
    r->port = r->plant->sources[0].port = free_port();
    r->plant->sources[0].poll_ms = 100;
    r->plant->sources[0].timeout_ms = 500;
    assert_true(sim_init(&r->sim, r->plant, r->values, 0, NULL));
    r->held = mem_array(r->plant->tag_count, sizeof(*r->held));
    r->told = mem_array(r->plant->tag_count, sizeof(*r->told));
    r->spike = -1;
    r->stop_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
}

static void free_replay(struct modbus_replay *r)
{
    for (size_t i = 0; i < r->plant->tag_count; i++) {
        mem_free(r->held[i].at);
        mem_free(r->told[i].at);
    }
    mem_free(r->held);
    mem_free(r->told);
    mem_free(r->mapped);
    sim_finish(&r->sim);
    sim_values_destroy(&r->values);
    plant_destroy(&r->plant);
    close(r->stop_fd);
}

TEST(history_gives_back_what_the_device_held)
{
    static struct modbus_replay r;
    if (access(data_path, R_OK) != 0) {
        print_message("# %s is not there\n", data_path);
        skip();
    }
    make_plant(&r);
    const char *asked = getenv("REPLAY_S");
    pthread_t device;
    char *folder = temp_folder();
    struct log *log = test_log();
    struct counters *counters = test_counters();
    struct store *store = test_store(r.plant);
    const struct historian_params params = { .log = log, .counters = counters, .plant = r.plant, .store = store, .folder = folder };
    store_listen(store, on_sample_event, &r);
    struct historian *historian = historian_start(&params);
    assert_non_null(historian);
    assert_int_equal(pthread_create(&device, NULL, device_main, &r), 0);
    struct source *source = source_start(log, r.plant, 0, store, counters);
    run(&r, store, asked ? atof(asked) : SHORT_S);
    source_stop(&source);
    historian_stop(&historian);
    eventfd_write(r.stop_fd, 1);
    pthread_join(device, NULL);
    struct history_reader *reader = history_reader_create(log, folder);
    struct history_tag *tags = history_tags(r.plant);
    double worst = 0;
    size_t told = 0;
    for (size_t i = 0; i < r.mapped_count; i++) {
        check_wire(&r, r.mapped[i]);
        check_history(&r, reader, &tags[r.mapped[i]], r.mapped[i], &worst);
        told += r.told[r.mapped[i]].count;
    }
    print_message("# %zu tags, %zu samples, %lld points kept; the worst is %.2f of its deviation off\n", r.mapped_count, told,
                  (long long)*counters_add(counters, "plantcast_history_points_total", "counter", ""), worst);
    mem_free(tags);
    history_reader_destroy(&reader);
    free_replay(&r);
}
