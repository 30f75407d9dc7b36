/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cost of computing the field, i.e. the values that the sensors' readings give at the vertices of an asset: elapsed time and
   processor time on all cores. Prints one JSON object per line. */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "base/clock.h"
#include "base/math/search.h"
#include "base/mem.h"
#include "field/field.h"
#include "tests/support/measure.h"
#include "tests/support/synthetic.h"
#include "tests/support/whole_field.h"
#include "value/quality.h"

#define VERTICES 66000
#define ROUNDS 60

struct field_bench {
    struct synthetic *plant;
    struct field *field;
    struct field_params params;
    size_t sensors;
    uint64_t random;
};

static void change_reading(struct field_bench *bench, size_t sensor)
{
    bench->plant->snapshot->readings[sensor].value = 100 * synthetic_random_unit(&bench->random);
}

static void change_all(struct field_bench *bench)
{
    for (size_t i = 0; i < bench->sensors; i++)
        change_reading(bench, i);
}

static void change_one(struct field_bench *bench)
{
    change_reading(bench, synthetic_random(&bench->random) % bench->sensors);
}

static void change_quality(struct field_bench *bench)
{
    struct reading *reading = &bench->plant->snapshot->readings[synthetic_random(&bench->random) % bench->sensors];
    reading->quality = quality_is_bad(reading->quality) ? QUALITY_GOOD : QUALITY_BAD_SENSOR_FAILURE;
}

static void mend_all(struct field_bench *bench)
{
    for (size_t i = 0; i < bench->sensors; i++)
        bench->plant->snapshot->readings[i].quality = QUALITY_GOOD;
}

static void change_nothing(struct field_bench *bench)
{
    (void)bench;
}

static void drag_power(struct field_bench *bench)
{
    bench->params.power = 1 + 4 * synthetic_random_unit(&bench->random);
}

static void drag_decay(struct field_bench *bench)
{
    bench->params.decay = 0.5 + synthetic_random_unit(&bench->random);
}

/* Measures how long the field takes to compute after change() has changed readings or parameters. goal_ms: longest time
   allowed; 0: no limit. */
static void measure(struct field_bench *bench, const char *name, void (*change)(struct field_bench *), double goal_ms)
{
    double ms[ROUNDS], work_ms[ROUNDS];
    for (int i = -5; i < ROUNDS; i++) {
        change(bench);
        double before_ms = measure_ms(CLOCK_PROCESS_CPUTIME_ID);
        int64_t began_ns = clock_mono_ns();
        if (!field_scalars(bench->field, 0, &bench->params, bench->plant->snapshot))
            abort();
        if (i < 0)
            continue;
        ms[i] = (double)(clock_mono_ns() - began_ns) / 1e6;
        work_ms[i] = measure_ms(CLOCK_PROCESS_CPUTIME_ID) - before_ms;
    }
    qsort(ms, ROUNDS, sizeof(*ms), compare_doubles);
    qsort(work_ms, ROUNDS, sizeof(*work_ms), compare_doubles);
    mend_all(bench);
    printf("{\"name\": \"%s\", \"value\": %.4f, \"p95\": %.4f, \"unit\": \"ms\", \"cpu\": %.4f", name, ms[ROUNDS / 2],
           ms[ROUNDS * 95 / 100], work_ms[ROUNDS / 2]);
    if (goal_ms > 0)
        printf(", \"goal\": [\"<=\", %g]", goal_ms);
    printf("}\n");
    fflush(stdout);
}

/* Measures for how long each call blocks the render thread, which computes the field piece by piece. */
static void measure_pieces(struct field_bench *bench, const char *kind, void (*change)(struct field_bench *))
{
    enum { MOST = 4096 };
    static double ms[MOST];
    size_t count = 0;
    for (int i = 0; i < ROUNDS; i++) {
        bool done = false;
        change(bench);
        while (!done && count < MOST) {
            int64_t began_ns = clock_mono_ns(), end_ns = began_ns + 6 * NS_PER_MS;
            do
                done = field_advance(bench->field, 0, &bench->params, bench->plant->snapshot, VERTICES, 1e6);
            while (!done && clock_mono_ns() < end_ns);
            ms[count++] = (double)(clock_mono_ns() - began_ns) / 1e6;
        }
    }
    qsort(ms, count, sizeof(*ms), compare_doubles);
    mend_all(bench);
    printf("{\"name\": \"field_%zu_%s_hold_ms\", \"value\": %.4f, \"p95\": %.4f, \"unit\": \"ms\", \"goal\": [\"<=\", 10]}\n",
           bench->sensors, kind, ms[count / 2], ms[count * 95 / 100]);
    fflush(stdout);
}

static void measure_named(struct field_bench *bench, const char *kind, void (*change)(struct field_bench *), double goal_ms)
{
    char *name = mem_printf("field_%zu_%s_ms", bench->sensors, kind);
    measure(bench, name, change, goal_ms);
    mem_free(name);
}

static void measure_plant(struct workers *workers, size_t sensors)
{
    struct field_bench bench = { .plant = synthetic_create(.vertices = VERTICES, .sensors = sensors, .seed = 1), .sensors = sensors };
    bench.field = field_create(workers, &bench.plant->scene);
    field_params_default(&bench.plant->plant, 0, &bench.params);
    measure_named(&bench, "all_readings", change_all, 4);
    measure_named(&bench, "one_reading", change_one, 0.1);
    measure_named(&bench, "no_reading", change_nothing, 0);
    measure_named(&bench, "one_quality", change_quality, 0);
    bench.params.distance = DISTANCE_EUCLIDEAN;
    measure_named(&bench, "euclidean_one_quality", change_quality, 0);
    measure_named(&bench, "drag_power", drag_power, 0);
    bench.params.interpolation = INTERPOLATION_PAPER;
    measure_named(&bench, "paper_all_readings", change_all, 4);
    measure_named(&bench, "paper_one_reading", change_one, 0.1);
    measure_named(&bench, "paper_one_quality", change_quality, 0);
    measure_named(&bench, "paper_drag_decay", drag_decay, 0);
    measure_pieces(&bench, "paper_one_quality", change_quality);
    measure_pieces(&bench, "paper_drag_decay", drag_decay);
    bench.params.interpolation = INTERPOLATION_SHEPARD;
    measure_pieces(&bench, "one_quality", change_quality);
    measure_pieces(&bench, "drag_power", drag_power);
    bench.params.interpolation = INTERPOLATION_PAPER;
    field_set_cache_limit(bench.field, 0);
    bench.params.decay = 1;
    measure_named(&bench, "paper_all_readings_uncached", change_all, 0);
    field_destroy(&bench.field);
    synthetic_destroy(&bench.plant);
}

/* Measures a plant with so many sensors that the field cannot cache each sensor's weights ("columns"), but recomputes them from
   distances at each change. */
static void measure_many(struct workers *workers, size_t sensors)
{
    struct field_bench bench = { .plant = synthetic_create(.vertices = VERTICES, .sensors = sensors, .seed = 1), .sensors = sensors };
    bench.field = field_create(workers, &bench.plant->scene);
    field_params_default(&bench.plant->plant, 0, &bench.params);
    measure_named(&bench, "all_readings", change_all, 300);
    field_destroy(&bench.field);
    synthetic_destroy(&bench.plant);
}

int main(void)
{
    struct workers *workers = workers_create(0);
    measure_plant(workers, 5);
    measure_plant(workers, 512);
    measure_many(workers, 4096);
    workers_destroy(&workers);
    return 0;
}
