/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cost of predicting a sensor's reading from the other sensors, for all sensors at once as the daemon does and for single ones,
   compared with the cost of recomputing the field after one reading changed. Uses a plate of 37,000 vertices with 5 and with
   512 sensors; prints one JSON object per line. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <cmocka.h>

#include "base/math/search.h"
#include "base/mem.h"
#include "field/field.h"
#include "field/neighbours.h"
#include "scene/scene_create.h"
#include "tests/support/cad.h"
#include "tests/support/measure.h"
#include "tests/support/model_maker.h"
#include "tests/support/prep_case.h"
#include "tests/support/whole_field.h"
#include "value/quality.h"

enum { ACROSS = 192, ROUNDS = 100, WARM_UP = 5 };
#define WIDTH_M 10.0

struct neighbours_bench {
    struct plant *plant;
    struct scene *scene;
    struct field *field;
    struct field_params params;
    struct snapshot *snapshot;
    struct neighbours_cache cache;
    struct cad_random random;
};

static void write_plant(struct prep_case *c, int sensors, bool gp, struct cad_random *random)
{
    struct cad cad = { 0 };
    struct text rows = { 0 };
    cad_plate(&cad, random, ACROSS, ACROSS, WIDTH_M, WIDTH_M, 0);
    maker_write_cad(c->folder, "model.glb", "plate", &cad);
    cad_finish(&cad);
    char *yaml = mem_printf("plant: { name: Plate }\n"
                            "assets: [{ id: P, model: model.glb, up: z }]\n"
                            "groups: [{ id: temperature, unit: K, min: 0, max: 100%s }]\n"
                            "sources: [{ id: plc, type: modbus, host: 127.0.0.1, byte_order: ABCD, address_base: 1 }]\n"
                            "tags: tags.csv\n",
                            gp ? ", interpolation: gp, gp: { range_m: 2, noise: 0.1 }" : "");
    prep_case_plant(c, yaml);
    mem_free(yaml);
    for (int i = 0; i < sensors; i++)
        text_add(&rows, "T%d,%d,Float,plc,temperature,P,,%g,%g,0\n", i, 400001 + 2 * i, WIDTH_M * cad_random(random),
                 WIDTH_M * cad_random(random));
    prep_case_tags(c, rows.at);
    text_finish(&rows);
}

static void change_reading(struct neighbours_bench *bench)
{
    size_t sensor = (size_t)(cad_random(&bench->random) * (double)bench->plant->tag_count);
    bench->snapshot->readings[sensor].value = 100 * cad_random(&bench->random);
    bench->snapshot->readings[sensor].changes++;
}

static void draw_field(struct neighbours_bench *bench)
{
    if (!field_scalars(bench->field, 0, &bench->params, bench->snapshot))
        abort();
}

/* Advances the time until the cached predictions have expired, then requests the predictions of all sensors. */
static void ask_all(struct neighbours_bench *bench)
{
    bench->snapshot->taken_mono_ns += 2 * NEIGHBOURS_FRESH_NS;
    if (neighbours_look(&bench->cache, bench->scene, 0, 0, bench->snapshot)->count != bench->plant->tag_count)
        abort();
}

/* Measures the processor time of work() on all cores. ms[] receives the times of all rounds in ms, sorted. Returns the median.
   */
static double time_of(struct neighbours_bench *bench, void (*work)(struct neighbours_bench *), double ms[ROUNDS])
{
    for (int i = -WARM_UP; i < ROUNDS; i++) {
        change_reading(bench);
        double before_ms = measure_ms(CLOCK_PROCESS_CPUTIME_ID);
        work(bench);
        if (i >= 0)
            ms[i] = measure_ms(CLOCK_PROCESS_CPUTIME_ID) - before_ms;
    }
    qsort(ms, ROUNDS, sizeof(*ms), compare_doubles);
    return ms[ROUNDS / 2];
}

static void print_row(const char *what, int sensors, const char *kind, const double ms[ROUNDS], double part, double goal_ms)
{
    printf("{\"name\": \"%s_%d_%s_ms\", \"value\": %.4f, \"p95\": %.4f, \"unit\": \"ms\"", what, sensors, kind, part * ms[ROUNDS / 2],
           part * ms[ROUNDS * 95 / 100]);
    if (goal_ms > 0)
        printf(", \"goal\": [\"<=\", %.4f]", goal_ms);
    printf("}\n");
    fflush(stdout);
}

static void measure(struct neighbours_bench *bench, int sensors, const char *kind)
{
    double ms[ROUNDS];
    double reading_ms = time_of(bench, draw_field, ms);
    print_row("reading", sensors, kind, ms, 1, 0);
    time_of(bench, ask_all, ms);
    print_row("predicted_all", sensors, kind, ms, 1, 0);
    print_row("predicted_each", sensors, kind, ms, 1. / sensors, reading_ms);
}

static void measure_plant(struct log *log, struct workers *workers, int sensors, bool gp)
{
    struct neighbours_bench bench = { .random = { 1 } };
    void *state;
    prep_case_set_up(&state);
    struct prep_case *c = state;
    write_plant(c, sensors, gp, &bench.random);
    prep_case_expect(c, "$PLANT", 0);
    bench.plant = plant_load_or_print(c->plant);
    char *prepared = bench.plant ? plant_prepared_folder(bench.plant) : NULL;
    bench.scene = prepared ? scene_create(log, bench.plant, prepared) : NULL;
    if (!bench.scene)
        abort();
    mem_free(prepared);
    bench.field = field_create(workers, bench.scene);
    bench.snapshot = snapshot_create(bench.plant->tag_count);
    for (size_t i = 0; i < bench.plant->tag_count; i++)
        bench.snapshot->readings[i] = (struct reading){ .value = 50, .quality = QUALITY_GOOD };
    field_params_default(bench.plant, 0, &bench.params);
    measure(&bench, sensors, gp ? "gp" : "shepard");
    neighbours_cache_finish(&bench.cache);
    field_destroy(&bench.field);
    snapshot_destroy(&bench.snapshot);
    scene_destroy(&bench.scene);
    plant_destroy(&bench.plant);
    prep_case_tear_down(&state);
}

int main(void)
{
    struct log *log = log_create(LOG_ERROR);
    struct workers *workers = workers_create(0);
    for (int gp = 0; gp < 2; gp++) {
        measure_plant(log, workers, 5, gp);
        measure_plant(log, workers, 512, gp);
    }
    workers_destroy(&workers);
    log_destroy(&log);
    return 0;
}
