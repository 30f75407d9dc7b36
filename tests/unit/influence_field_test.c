/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prepared interpolations from the plant file to the field: what is written, what is refused, what is added up, and what stays unknown. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

#include "base/mem.h"
#include "field/field.h"
#include "scene/scene_create.h"
#include "tests/support/cad.h"
#include "tests/support/model_maker.h"
#include "tests/support/prep_case.h"
#include "tests/support/temp.h"
#include "value/quality.h"

#define STRIP_M 10.0
#define WIDTH_M 0.1
#define SENSORS 12 /* more than are always summed anew */

static struct log *the_log;

static int set_up(void **state)
{
    the_log = log_create(LOG_ERROR);
    return prep_case_set_up(state);
}

static int tear_down(void **state)
{
    log_destroy(&the_log);
    return prep_case_tear_down(state);
}

static void write_model(const struct prep_case *c)
{
    struct cad_random random;
    struct cad cad = { 0 };
    struct maker maker;
    size_t size;
    cad_random_start(&random);
    cad_plate(&cad, &random, 100, 3, STRIP_M, WIDTH_M, 0);
    maker_init(&maker);
    int positions = maker_numbers(&maker, cad.positions, cad.vertex_count * sizeof(*cad.positions), FLOAT, cad.vertex_count, "VEC3");
    int indices =
        maker_numbers(&maker, cad.triangles, cad.triangle_count * 3 * sizeof(*cad.triangles), UINT, cad.triangle_count * 3, "SCALAR");
    maker_node(&maker, "strip", maker_mesh(&maker, json_pack("{s:{s:i},s:i}", "attributes", "POSITION", positions, "indices", indices)),
               NULL);
    char *glb = maker_glb(&maker, &size);
    mem_free(temp_write(c->folder, "model.glb", glb, size));
    mem_free(glb);
    maker_finish(&maker);
    cad_finish(&cad);
}

/* Sensors stand 0.5 m, 1.3 m, 2.1 m and so on from the strip's end. */
static double place_of(size_t sensor)
{
    return 0.5 + 0.8 * (double)sensor;
}

static void write_plant(struct prep_case *c, const char *wall, const char *group, size_t sensors)
{
    char *yaml = mem_printf("plant: { name: Strip }\n"
                            "assets:\n"
                            "  - { id: S, model: model.glb, up: z%s }\n"
                            "groups:\n"
                            "  - { id: temperature, unit: K, min: 0, max: 100%s }\n"
                            "sources:\n"
                            "  - { id: plc, type: modbus, host: 127.0.0.1, byte_order: CDAB, address_base: 1 }\n"
                            "tags: tags.csv\n",
                            wall, group);
    struct text rows = { 0 };
    for (size_t i = 0; i < sensors; i++)
        text_add(&rows, "T%zu,%zu,Float,plc,temperature,S,,%g,0.05,0\n", i, 400001 + 2 * i, place_of(i));
    prep_case_plant(c, yaml);
    prep_case_tags(c, rows.at);
    text_finish(&rows);
    mem_free(yaml);
}

struct plant_in_use {
    struct plant *plant;
    struct scene *scene;
    struct workers *workers;
    struct field *field;
    struct snapshot *snapshot;
    struct field_params params;
    const struct scalars *scalars;
};

static bool use(struct plant_in_use *u, const struct prep_case *c)
{
    char *prepared = NULL;
    *u = (struct plant_in_use){ .plant = plant_load_or_print(c->plant) };
    assert_non_null(u->plant);
    prepared = plant_prepared_folder(u->plant);
    u->scene = scene_create(the_log, u->plant, prepared);
    mem_free(prepared);
    if (!u->scene) {
        plant_destroy(&u->plant);
        return false;
    }
    u->workers = workers_create(1);
    u->field = field_create(u->workers, u->scene);
    u->snapshot = snapshot_create(u->plant->tag_count);
    for (size_t i = 0; i < u->plant->tag_count; i++)
        u->snapshot->readings[i] = (struct reading){ .value = 10.0 * (double)i, .quality = QUALITY_GOOD };
    field_params_default(u->plant, 0, &u->params);
    return true;
}

/* A plant with these keys of the asset and of the group, prepared and in use. */
static void begin(struct plant_in_use *u, struct prep_case *c, const char *wall, const char *group, size_t sensors)
{
    write_model(c);
    write_plant(c, wall, group, sensors);
    prep_case_expect(c, "$PLANT", 0);
    assert_true(use(u, c));
}

static void finish(struct plant_in_use *u)
{
    field_destroy(&u->field);
    workers_destroy(&u->workers);
    scene_destroy(&u->scene);
    snapshot_destroy(&u->snapshot);
    plant_destroy(&u->plant);
}

static const struct scalar *look(struct plant_in_use *u, double x_m)
{
    const struct asset_view *view = &u->scene->assets[0].file->view;
    size_t best = 0;
    assert_null(field_params_wrong(u->plant, &u->params));
    u->scalars = field_scalars(u->field, 0, &u->params, u->snapshot);
    assert_non_null(u->scalars);
    for (size_t v = 1; v < view->header->vertex_count; v++) {
        double of_v = fabs((double)view->positions_m[v][0] + view->header->origin_m[0] - x_m);
        if (of_v < fabs((double)view->positions_m[best][0] + view->header->origin_m[0] - x_m))
            best = v;
    }
    return &u->scalars->at[best];
}

static void test_harmonic_is_straight_and_follows_readings(void **state)
{
    struct prep_case *c = *state;
    struct plant_in_use u;
    begin(&u, c, "", ", interpolation: harmonic, disc_m: 0.1", SENSORS);
    for (size_t i = 0; i < SENSORS; i++)
        assert_true(fabs((double)look(&u, place_of(i))->value - 10.0 * (double)i) < 0.05);
    assert_true(fabs((double)look(&u, place_of(3) + 0.4)->value - 35) < 0.5);
    u.snapshot->readings[4].value = 90; /* one reading: its column alone */
    assert_true(fabs((double)look(&u, place_of(3) + 0.4)->value - 60) < 0.5);
    assert_true(fabs((double)look(&u, place_of(4))->value - 90) < 0.1);
    finish(&u);
}

/* Readings that came one by one leave what all at once give. */
static void test_steps_and_lost_sensors_agree_with_all_anew(void **state)
{
    struct prep_case *c = *state;
    struct plant_in_use u, fresh;
    begin(&u, c, ", thickness_m: 0.01", ", interpolation: fin, ambient: 20, disc_m: 0.1, prepare: [harmonic], fill: neighbours", SENSORS);
    assert_true(use(&fresh, c));
    for (int pass = 0; pass < 2; pass++) {
        u.params.interpolation = fresh.params.interpolation = pass ? INTERPOLATION_HARMONIC : INTERPOLATION_FIN;
        for (int step = 0; step < 40; step++) {
            size_t i = (size_t)(step * 7) % SENSORS;
            u.snapshot->readings[i].value = 50 + step;
            u.snapshot->readings[5].quality = step % 8 < 4 ? QUALITY_GOOD : QUALITY_BAD;
            u.snapshot->readings[6].quality = step % 4 < 2 ? QUALITY_GOOD : QUALITY_BAD;
            look(&u, 0);
        }
        memcpy(fresh.snapshot->readings, u.snapshot->readings, SENSORS * sizeof(*u.snapshot->readings));
        look(&fresh, 0);
        for (size_t v = 0; v < u.scalars->count; v++) {
            assert_true(fabs((double)(u.scalars->at[v].value - fresh.scalars->at[v].value)) < 1e-3);
            assert_int_equal(u.scalars->at[v].lacking, fresh.scalars->at[v].lacking);
        }
    }
    finish(&u);
    finish(&fresh);
}

static void test_lost_sensor_is_bridged_and_its_place_unknown(void **state)
{
    struct prep_case *c = *state;
    struct plant_in_use u;
    begin(&u, c, "", ", interpolation: harmonic, disc_m: 0.1", SENSORS);
    u.snapshot->readings[4] = (struct reading){ .value = 5000, .quality = QUALITY_BAD };
    assert_int_equal(look(&u, place_of(4))->no_data, 255);
    assert_true(fabs((double)look(&u, place_of(3) + 0.2)->value - 31.7) < 0.4); /* straight from 3 to 5, discs apart */
    assert_true(look(&u, place_of(3) + 0.3)->uncertain < 128);
    u.snapshot->readings[5].quality = QUALITY_UNCERTAIN; /* half of what stands in for the lost one */
    assert_true(look(&u, place_of(4) - 0.3)->uncertain > 127);
    u.snapshot->readings[5].quality = QUALITY_GOOD;
    u.params.fill = FILL_NEIGHBOURS;
    assert_true(fabs((double)look(&u, place_of(4))->value - 40) < 0.5);
    for (size_t i = 0; i < SENSORS; i++)
        u.snapshot->readings[i].quality = QUALITY_BAD;
    assert_int_equal(look(&u, 3)->no_data, 255);
    finish(&u);
}

/* sqrt(k t / h) = 0.236 m: what is 2.3 times as far from the last sensor is unknown. */
static void test_fin_knows_how_far_it_sees(void **state)
{
    struct prep_case *c = *state;
    struct plant_in_use u;
    begin(&u, c, ", thickness_m: 0.01", ", interpolation: fin, ambient: 20, disc_m: 0.1", 2);
    u.snapshot->readings[1].value = 100;
    const double decay_m = sqrt(50 * 0.01 / 9);
    for (double x = 0.1; x < 3 * decay_m; x += 0.1) {
        const struct scalar *at = look(&u, place_of(1) + x);
        double expected = 20 + 80 * exp(-fmax(x - 0.0957, 0) / decay_m);
        assert_true(fabs((double)at->value - expected) < 2.5); /* the nearest vertex is up to 5 cm away */
        if (fabs(x - 0.0957 - decay_m * log(10)) > 0.1)
            assert_int_equal(at->no_data, x - 0.0957 < decay_m * log(10) ? 0 : 255);
    }
    u.params.show = SHOW_OPERATOR;
    assert_non_null(field_params_wrong(u.plant, &u.params));
    field_params_set_show(u.plant, &u.params, SHOW_OPERATOR);
    assert_int_equal(u.params.interpolation, INTERPOLATION_SHEPARD); /* harmonic is not prepared */
    assert_null(field_params_wrong(u.plant, &u.params));
    u.params.interpolation = INTERPOLATION_FIN;
    u.params.show = SHOW_DIFFERENCE; /* without a baseline there is nothing; the rule must not add what is around */
    u.params.baseline = 1;
    assert_true(look(&u, place_of(1))->no_data == 255);
    finish(&u);
}

static void test_what_is_missing_is_said(void **state)
{
    struct prep_case *c = *state;
    write_model(c);
    write_plant(c, "", ", prepare: [harmonic, fin]", 2);
    prep_case_expect(c, "$PLANT", 1);
    prep_case_says(&c->err, "group temperature: fin needs 'ambient', what is around the assets, in K");
    prep_case_says(&c->err, "asset S: fin, which group temperature asks for, needs 'thickness_m'");
    write_plant(c, "", ", prepare: [kriging]", 2);
    prep_case_expect(c, "$PLANT", 1);
    prep_case_says(&c->err, "prepare: expected harmonic or fin");
    write_plant(c, ", thickness_m: 0", ", prepare: [harmonic]", 2);
    prep_case_expect(c, "$PLANT", 1);
    prep_case_says(&c->err, "thickness_m");
}

static void test_not_prepared_is_refused(void **state)
{
    struct prep_case *c = *state;
    struct plant_in_use u;
    begin(&u, c, "", "", 2);
    u.params.interpolation = INTERPOLATION_HARMONIC;
    assert_non_null(strstr(field_params_wrong(u.plant, &u.params), "not prepared"));
    finish(&u);
    write_plant(c, "", ", prepare: [harmonic]", 2); /* the plant file asks for it, nobody prepared it */
    assert_false(use(&u, c));
    prep_case_expect(c, "$PLANT", 0);
    assert_true(use(&u, c));
    finish(&u);
    write_plant(c, "", ", prepare: [harmonic], disc_m: 0.2", 2);
    assert_false(use(&u, c));
}

/* A file that is gone or damaged is made anew, and never taken. */
static void test_damaged_file(void **state)
{
    struct prep_case *c = *state;
    struct plant_in_use u;
    uint64_t key;
    write_model(c);
    write_plant(c, "", ", interpolation: harmonic", 2);
    prep_case_expect(c, "$PLANT", 0);
    char *path = prep_case_file(c, ".influence", &key);
    for (int way = 0; way < 2; way++) {
        FILE *file = fopen(path, "r+b");
        assert_non_null(file);
        assert_int_equal(fseek(file, 300, SEEK_SET), 0);
        fputc('x', file);
        fputc('y', file);
        fclose(file);
        if (way)
            assert_int_equal(truncate(path, 100), 0);
        assert_false(use(&u, c));
        prep_case_expect(c, "$PLANT", 0);
        prep_case_says(&c->err, "the influence of its sensors is missing or damaged");
        assert_true(use(&u, c));
        finish(&u);
    }
    write_plant(c, "", "", 2); /* nobody asks for it any more */
    prep_case_expect(c, "$PLANT", 0);
    assert_int_not_equal(access(path, F_OK), 0);
    mem_free(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_harmonic_is_straight_and_follows_readings, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_steps_and_lost_sensors_agree_with_all_anew, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_lost_sensor_is_bridged_and_its_place_unknown, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_fin_knows_how_far_it_sees, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_what_is_missing_is_said, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_not_prepared_is_refused, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_damaged_file, set_up, tear_down),
    };
    cmocka_set_message_output(CM_OUTPUT_TAP);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
