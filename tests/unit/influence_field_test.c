/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Interpolations that plantcast-prep prepares (harmonic, fin, gp), from the plant file to the field's values: what is prepared,
   which settings are refused, how changed readings are added, and where the field is unknown. */
#include "tests/support/test.h"
#include <unistd.h>

#include "field/directions.h"
#include "field/field.h"
#include "field/neighbours.h"
#include "placing/sensor_suggest.h"
#include "plant/exact.h"
#include "protocol/asset_distance.h"
#include "scene/scene_create.h"
#include "tests/support/surface_case.h"
#include "tests/support/model_maker.h"
#include "tests/support/prep_case.h"
#include "tests/support/whole_field.h"
#include "value/quality.h"

#define STRIP_M 10.0
#define WIDTH_M 0.1
#define SENSORS 12 /* more sensors than the fast path sums in one pass */

#define CASE(name) TEST_ON(struct prep_case *c, name, prep_case_set_up, prep_case_tear_down)

static void write_model(const struct prep_case *c)
{
    struct cad_random random;
    struct cad *cad = test_cad();
    cad_random_start(&random);
    cad_plate(cad, &random, 100, 3, STRIP_M, WIDTH_M, 0);
    maker_write_cad(c->folder, "model.glb", "strip", cad);
}

/* Returns a sensor's distance from the strip's end: 0.5 m, 1.3 m, 2.1 m and so on. */
static double place_of(size_t sensor)
{
    return 0.5 + 0.8 * (double)sensor;
}

static void write_plant_to(struct prep_case *c, const char *max, const char *wall, const char *group, size_t sensors)
{
    char *yaml = test_printf("plant: { name: Strip }\n"
                             "assets:\n"
                             "  - { id: S, model: model.glb, up: z%s }\n"
                             "groups:\n"
                             "  - { id: temperature, unit: K, min: 0, max: %s%s }\n"
                             "sources:\n"
                             "  - { id: plc, type: modbus, host: 127.0.0.1, byte_order: CDAB, address_base: 1 }\n"
                             "tags: tags.csv\n",
                             wall, max, group);
    struct text *rows = test_text();
    for (size_t i = 0; i < sensors; i++)
        text_add(rows, "T%zu,%zu,Float,plc,temperature,S,,%g,0.05,0\n", i, 400001 + 2 * i, place_of(i));
    prep_case_plant(c, yaml);
    prep_case_tags(c, rows->at);
}

static void write_plant(struct prep_case *c, const char *wall, const char *group, size_t sensors)
{
    write_plant_to(c, "100", wall, group, sensors);
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

static void release(void *resource)
{
    struct plant_in_use *u = resource;
    field_destroy(&u->field);
    workers_destroy(&u->workers);
    scene_destroy(&u->scene);
    snapshot_destroy(&u->snapshot);
    plant_destroy(&u->plant);
    mem_free(u);
}

/* Opens the plant for the test. Returns NULL if it was not prepared for what it asks. */
static struct plant_in_use *use(const struct prep_case *c)
{
    struct plant_in_use *u = mem_new(sizeof(*u));
    owned_add(release, u);
    u->plant = plant_load_or_print(c->plant);
    assert_non_null(u->plant);
    u->scene = scene_create(the_log, u->plant, test_memory(plant_prepared_folder(u->plant)));
    if (!u->scene)
        return NULL;
    u->workers = workers_create(1);
    u->field = field_create(u->workers, u->scene);
    u->snapshot = snapshot_create(u->plant->tag_count);
    for (size_t i = 0; i < u->plant->tag_count; i++)
        u->snapshot->readings[i] = (struct reading){ .value = 10.0 * (double)i, .quality = QUALITY_GOOD };
    field_params_default(u->plant, 0, &u->params);
    return u;
}

static struct plant_in_use *use_prepared(const struct prep_case *c)
{
    struct plant_in_use *u = use(c);
    assert_non_null(u);
    return u;
}

/* Prepares a plant with `sensors` sensors, in which `wall` and `group` are appended to the asset's and the group's keys, and
   opens it. */
static struct plant_in_use *begin(struct prep_case *c, const char *wall, const char *group, size_t sensors)
{
    write_model(c);
    write_plant(c, wall, group, sensors);
    prep_case_expect(c, "$PLANT", 0);
    return use_prepared(c);
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

CASE(test_harmonic_is_straight_and_follows_readings)
{
    struct plant_in_use *u = begin(c, "", ", interpolation: harmonic, disc_m: 0.1", SENSORS);
    for (size_t i = 0; i < SENSORS; i++)
        assert_true(fabs((double)look(u, place_of(i))->value - 10.0 * (double)i) < 0.05);
    assert_true(fabs((double)look(u, place_of(3) + 0.4)->value - 35) < 0.5);
    /* sensor 4's reading is raised: near the sensor the field rises by that change times the sensor's weight */
    u->snapshot->readings[4].value = 90;
    assert_true(fabs((double)look(u, place_of(3) + 0.4)->value - 60) < 0.5);
    assert_true(fabs((double)look(u, place_of(4))->value - 90) < 0.1);
}

/* Readings changed one by one, some lost and back, must leave the same field as the same readings set at once. */
CASE(test_steps_and_lost_sensors_agree_with_all_anew)
{
    struct plant_in_use *u =
        begin(c, ", thickness_m: 0.01", ", interpolation: fin, ambient: 20, disc_m: 0.1, prepare: [harmonic], fill: neighbours", SENSORS);
    struct plant_in_use *fresh = use_prepared(c);
    for (int pass = 0; pass < 2; pass++) {
        u->params.interpolation = fresh->params.interpolation = pass ? INTERPOLATION_HARMONIC : INTERPOLATION_FIN;
        for (int step = 0; step < 40; step++) {
            size_t i = (size_t)(step * 7) % SENSORS;
            u->snapshot->readings[i].value = 50 + step;
            u->snapshot->readings[5].quality = step % 8 < 4 ? QUALITY_GOOD : QUALITY_BAD;
            u->snapshot->readings[6].quality = step % 4 < 2 ? QUALITY_GOOD : QUALITY_BAD;
            look(u, 0);
        }
        memcpy(fresh->snapshot->readings, u->snapshot->readings, SENSORS * sizeof(*u->snapshot->readings));
        look(fresh, 0);
        for (size_t v = 0; v < u->scalars->count; v++) {
            assert_true(fabs((double)(u->scalars->at[v].value - fresh->scalars->at[v].value)) < 1e-3);
            assert_int_equal(u->scalars->at[v].lacking, fresh->scalars->at[v].lacking);
        }
    }
}

CASE(test_lost_sensor_is_bridged_and_its_place_unknown)
{
    struct plant_in_use *u = begin(c, "", ", interpolation: harmonic, disc_m: 0.1", SENSORS);
    u->snapshot->readings[4] = (struct reading){ .value = 5000, .quality = QUALITY_BAD };
    assert_int_equal(look(u, place_of(4))->no_data, 255);
    /* sensor 4 is lost: from the edge of the disc that sensor 3 covers to that of sensor 5, the field is linear */
    assert_true(fabs((double)look(u, place_of(3) + 0.2)->value - 31.7) < 0.4);
    assert_true(look(u, place_of(3) + 0.3)->uncertain < 128);
    /* sensor 5, one of the two whose readings fill the lost sensor's gap, is Uncertain: the values in the gap become uncertain
       */
    u->snapshot->readings[5].quality = QUALITY_UNCERTAIN;
    assert_true(look(u, place_of(4) - 0.3)->uncertain > 127);
    u->snapshot->readings[5].quality = QUALITY_GOOD;
    u->params.fill = FILL_NEIGHBOURS;
    assert_true(fabs((double)look(u, place_of(4))->value - 40) < 0.5);
    for (size_t i = 0; i < SENSORS; i++)
        u->snapshot->readings[i].quality = QUALITY_BAD;
    assert_int_equal(look(u, 3)->no_data, 255);
}

/* Along the strip, a fin's temperature decays within sqrt(k t / h) = 0.236 m (conductivity, thickness, heat transfer). The
   field is unknown more than 2.3 times that away from the last sensor, where less than a tenth of the sensor's difference from
   the ambient value is left. */
CASE(test_fin_knows_how_far_it_sees)
{
    struct plant_in_use *u = begin(c, ", thickness_m: 0.01", ", interpolation: fin, ambient: 20, disc_m: 0.1", 2);
    u->snapshot->readings[1].value = 100;
    const double decay_m = sqrt(50 * 0.01 / 9);
    for (double x = 0.1; x < 3 * decay_m; x += 0.1) {
        const struct scalar *at = look(u, place_of(1) + x);
        double expected = 20 + 80 * exp(-fmax(x - 0.0957, 0) / decay_m);
        /* tolerance of 2.5, because look() reads the nearest vertex, up to 5 cm from x */
        assert_true(fabs((double)at->value - expected) < 2.5);
        if (fabs(x - 0.0957 - decay_m * log(10)) > 0.1)
            assert_int_equal(at->no_data, x - 0.0957 < decay_m * log(10) ? 0 : 255);
    }
    u->params.show = SHOW_OPERATOR;
    assert_non_null(field_params_wrong(u->plant, &u->params));
    field_params_set_show(u->plant, &u->params, SHOW_OPERATOR);
    assert_int_equal(u->params.interpolation, INTERPOLATION_SHEPARD); /* harmonic is not prepared */
    assert_null(field_params_wrong(u->plant, &u->params));
    u->params.interpolation = INTERPOLATION_FIN;
    /* a difference from a baseline that does not exist has no data; in particular, the ambient value does not count as one
       */
    u->params.show = SHOW_DIFFERENCE;
    u->params.baseline = 1;
    assert_true(look(u, place_of(1))->no_data == 255);
}

/* Beyond the last sensor a fin's values decay as exp(-x / d), so the true value half-way between two points is their geometric
   mean, while triangles interpolate linearly. With triangles of 0.1 m and d = 0.236 m the error matters: picks must state it
   and be marked as inexact. */
CASE(test_picks_of_fin_tell_their_error)
{
    size_t marked = 0, off = 0, compared = 0;
    struct plant_in_use *u = begin(c, ", thickness_m: 0.01", ", interpolation: fin, ambient: 20, disc_m: 0.1", 2);
    u->snapshot->readings[1].value = 100;
    const struct asset_view *view = &u->scene->assets[0].file->view;
    look(u, 0);
    for (uint32_t t = 0; t < view->primitives[0].index_count / 3; t++)
        for (int k = 0; k < 3; k++) {
            struct field_place place = { .parts = { 0.5, 0.5, 0 } };
            struct field_point point;
            double x_m[2], above[2];
            for (int i = 0; i < 3; i++)
                place.corners[i] = view->indices[3 * t + (uint32_t)((k + i) % 3)];
            for (int i = 0; i < 2; i++) {
                x_m[i] = (double)view->positions_m[place.corners[i]][0] + view->header->origin_m[0] - place_of(1);
                above[i] = (double)u->scalars->at[place.corners[i]].value - 20;
            }
            if (fmin(x_m[0], x_m[1]) < 0.25 || fmax(x_m[0], x_m[1]) > 0.8)
                continue;
            assert_true(field_at(u->field, 0, &u->params, u->snapshot, &place, &point));
            double error = fabs(point.value - 20 - sqrt(above[0] * above[1]));
            assert_true(error <= fmax(point.drawn_error, 100.0 / 255));
            assert_true(point.uncertain == (point.drawn_error > 0));
            marked += point.uncertain;
            off += error > 100.0 / 255;
            compared++;
        }
    print_message("%zu places, %zu off by more than a step of colour, %zu marked\n", compared, off, marked);
    assert_true(off > 0 && marked < compared);
    u->snapshot->readings[0].value = u->snapshot->readings[1].value = 20; /* the readings now equal those of the neighbouring tags */
    assert_true(look(u, place_of(1) + 0.3)->uncertain == 0);
    assert_true(u->scalars->drawn_error == 0);
    /* with a tenth of the thickness, d is 0.075 m: the field is inexact in most triangles */
    u = begin(c, ", thickness_m: 0.001", ", interpolation: fin, ambient: 20, disc_m: 0.1", SENSORS);
    look(u, 0);
    assert_true(u->scalars->drawn_error > 1);
}

/* With a high power, small errors of distances along the surface change the field where two sensors have similar weights. Picks
   must state the resulting error there. */
CASE(test_errors_of_distances_are_stated_for_high_powers)
{
    for (double power = 4; power <= 16; power *= 2) {
        size_t marked = 0;
        char *group = test_printf(", power: %g", power);
        struct plant_in_use *u = begin(c, "", group, 2);
        u->snapshot->readings[1].value = 100;
        const struct asset_view *view = &u->scene->assets[0].file->view;
        const struct asset_primitive *finest = &view->primitives[view->levels[0].first_primitive];
        look(u, 0);
        for (uint32_t i = finest->first_index; i < finest->first_index + finest->index_count; i++) {
            const uint32_t v = view->indices[i];
            const struct field_place place = { .corners = { v, v, v }, .parts = { 1 } };
            struct field_point point;
            double longer = pow(1 + PLANT_DISTANCE_ERROR, power), shorter = pow(1 - PLANT_DISTANCE_ERROR, power), weights[2];
            assert_true(field_at(u->field, 0, &u->params, u->snapshot, &place, &point));
            for (size_t s = 0; s < 2; s++)
                weights[s] = pow(fmax((double)asset_distance_m(view, s, v), 1e-6), -power);
            double most = 100 * weights[1] * longer / (weights[1] * longer + weights[0] * shorter) - point.value;
            if (power > 4 && most > 1.01 * fmax(point.drawn_error, 100.0 / 255))
                fail_msg("power %g, vertex %u: a value of %g may err by %g, %g stated", power, v, point.value, most, point.drawn_error);
            assert_true(point.uncertain == (point.drawn_error > 0));
            marked += point.uncertain;
        }
        print_message("power %g: %zu of %u corners are marked\n", power, marked, finest->index_count);
        assert_true(power > 4 ? marked > 0 && marked < finest->index_count : marked == 0);
    }
}

/* Half-way between sensors that read 20 and 21, a third one far away, which reads 100, has no weight: a pick there must not
   report an error. Pictures do mark the place, because their marks cannot depend on single readings. */
CASE(test_picks_look_at_the_readings_that_matter)
{
    const double values[] = { 20, 21, 100 };
    size_t compared[2] = { 0 };
    struct plant_in_use *u = begin(c, "", ", power: 16", 3);
    for (size_t s = 0; s < 3; s++)
        u->snapshot->readings[s].value = values[s];
    const struct asset_view *view = &u->scene->assets[0].file->view;
    const struct asset_primitive *finest = &view->primitives[view->levels[0].first_primitive];
    for (uint32_t i = finest->first_index; i < finest->first_index + finest->index_count; i++) {
        const uint32_t v = view->indices[i];
        const double x_m = (double)view->positions_m[v][0] + view->header->origin_m[0];
        const struct field_place place = { .corners = { v, v, v }, .parts = { 1 } };
        struct field_point point;
        for (size_t s = 0; s < 2; s++) {
            if (fabs(x_m - place_of(s) - 0.4) > 0.03)
                continue;
            look(u, x_m);
            assert_true(u->scalars->at[v].uncertain > 127);
            assert_true(field_at(u->field, 0, &u->params, u->snapshot, &place, &point));
            assert_int_equal(point.uncertain, s == 1);
            compared[s]++;
        }
    }
    assert_true(compared[0] > 0 && compared[1] > 0);
}

/* Distances computed by the paper's heat method agree with exact ones within 6 cm on a strip 10 m long and 0.1 m wide. */
CASE(test_distances_by_heat)
{
    float ours[64];
    struct plant_in_use *u = begin(c, "", ", geodesic: heat", 3);
    assert_int_equal(u->params.distance, DISTANCE_HEAT);
    for (int pass = 0; pass < 2; pass++) {
        u->params.show = pass ? SHOW_VALUE : SHOW_DISTANCE;
        u->params.sensor = pass ? -1 : 1;
        for (int i = 0; i < 64; i++) {
            double x_m = STRIP_M * i / 63;
            u->params.distance = DISTANCE_GEODESIC;
            ours[i] = look(u, x_m)->value;
            u->params.distance = DISTANCE_HEAT;
            assert_true(fabs((double)(look(u, x_m)->value - ours[i])) < (pass ? 0.3 : 0.06));
            assert_true(pass || fabs((double)ours[i] - fabs(x_m - place_of(1))) < 0.12);
        }
        u->params.distance = DISTANCE_HEAT;
        bool differs = false; /* some values must differ between the two, which proves that the heat distances were used */
        for (int i = 0; i < 64; i++)
            differs = differs || look(u, STRIP_M * i / 63)->value != ours[i];
        assert_true(differs);
    }
    write_plant(c, "", "", 3);
    prep_case_expect(c, "$PLANT", 0);
    u = use_prepared(c);
    u->params.distance = DISTANCE_HEAT;
    assert_non_null(strstr(field_params_wrong(u->plant, &u->params), "geodesic: heat"));
    /* the plant file now asks for heat distances, which were not prepared, so the plant is refused */
    write_plant(c, "", ", geodesic: heat", 3);
    assert_null(use(c));
    write_plant(c, "", ", geodesic: diffusion", 3);
    prep_case_expect(c, "$PLANT", 1);
    prep_case_says(&c->err, "geodesic: expected");
}

/* Writes a tag list of four sensors along the strip that also have a direction: by tags of its three components, or by a tag of
   its bearing. */
static void write_directions(struct prep_case *c, bool bearings)
{
    static const char *const directions[2] = { "U%zu V%zu W%zu", "B%zu" };
    struct text *rows = test_text();
    text_add(rows, "Tag Name,Address,Data Type,Source,Group,Asset,X,Y,Z,Direction\n");
    for (size_t i = 0; i < 4; i++) {
        text_add(rows, "T%zu,%zu,Float,plc,temperature,S,%g,0.05,0,", i, 400001 + 2 * i, 2 + 2 * (double)i);
        text_add(rows, directions[bearings], i, i, i);
        text_add(rows, "\n");
    }
    for (size_t i = 0; i < 4; i++)
        for (size_t k = 0; k < 4; k++)
            text_add(rows, "%c%zu,%zu,Float,plc,,,,,,\n", "UVWB"[k], i, 400101 + 8 * i + 2 * k);
    temp_write(c->folder, "tags.csv", rows->at, rows->length);
}

static struct direction points_at(struct plant_in_use *u, double x_m)
{
    const struct asset_view *view = &u->scene->assets[0].file->view;
    struct direction_place place = { .weights = { 1, 0, 0 }, .normal = { 0, 0, 1 } };
    struct sensor_direction *said;
    struct direction found;
    double best_m = INFINITY;
    for (uint32_t v = 0; v < view->header->vertex_count; v++) {
        double away_m = fabs((double)view->positions_m[v][0] + view->header->origin_m[0] - x_m);
        if (away_m < best_m)
            place.corners[0] = v;
        best_m = fmin(best_m, away_m);
    }
    size_t count = directions_read(u->scene, 0, 0, u->snapshot, &said);
    assert_int_equal(count, 4);
    directions_find(&(struct direction_sources){ u->scene, 0, &u->params, said, count }, &place, 1, &found);
    mem_free(said);
    return found;
}

static void say(struct plant_in_use *u, const char *tag, size_t sensor, double value)
{
    u->snapshot->readings[plant_find_tag(u->plant, test_printf("%s%zu", tag, sensor))].value = value;
}

static void expect_along(const struct direction *found, double x, double y)
{
    assert_true(found->known && fabs((double)found->along[0] - x) < 0.02 && fabs((double)found->along[1] - y) < 0.02 &&
                fabs((double)found->along[2]) < 1e-6);
}

/* At a point, the sensors' directions are averaged with weights 1 / D^2; the direction is unknown where they cancel out. */
CASE(test_directions)
{
    write_model(c);
    write_plant(c, "", "", 1);
    write_directions(c, false);
    assert_null(use(c)); /* directions are not prepared yet */
    prep_case_expect(c, "$PLANT", 0);
    struct plant_in_use *u = use_prepared(c);
    for (size_t i = 0; i < 4; i++) {
        say(u, "T", i, 5);
        say(u, "U", i, 3);
        say(u, "V", i, i < 2 ? 4 : -4);
        say(u, "W", i, 0);
    }
    struct direction found = points_at(u, 2);
    expect_along(&found, 0.6, 0.8);
    found = points_at(u, 5);
    expect_along(&found, 1, 0);
    say(u, "U", 1, 0), say(u, "U", 2, 0);
    say(u, "T", 0, 0), say(u, "T", 3, 0); /* the sensors at both ends read speed 0 and so count as without direction */
    found = points_at(u, 5);
    assert_false(found.known); /* half-way between two opposite directions */
    found = points_at(u, 4.5);
    expect_along(&found, 0, 1);
    struct reading *lost = &u->snapshot->readings[plant_find_tag(u->plant, "V1")];
    lost->quality = QUALITY_UNCERTAIN;
    assert_true(points_at(u, 4.2).uncertain && !points_at(u, 5.8).uncertain);
    lost->quality = QUALITY_BAD;
    assert_false(points_at(u, 4.5).known);
    assert_true(points_at(u, 5.5).known);
    lost->quality = QUALITY_GOOD;
    say(u, "V", 1, 0.1), say(u, "W", 1, 5); /* this vector is almost perpendicular to the strip, so it has no direction along the surface */
    assert_false(points_at(u, 4.5).known);
    write_directions(c, true);
    prep_case_expect(c, "$PLANT", 0);
    u = use_prepared(c);
    for (size_t i = 0; i < 4; i++) {
        say(u, "T", i, i == 3 ? -1 : 1);
        say(u, "B", i, 90.0 * (double)i);
    }
    for (size_t i = 0; i < 4; i++) { /* bearings run clockwise from +Y; a negative value points the other way */
        found = points_at(u, 2 + 2 * (double)i);
        expect_along(&found, (const double[]){ 0, 1, 0, 1 }[i], (const double[]){ 1, 0, -1, 0 }[i]);
    }
}

/* Inside a triangle as long as the strip, directions are weighed by the distances of the point itself: at a sensor in its middle,
   only that sensor counts. Linear means of the corners' distances would put the point 3.2 m away from the sensor. */
CASE(test_directions_inside_a_large_triangle)
{
    static const double ends[3][2] = { { 0, 0.05 }, { STRIP_M, 0 }, { STRIP_M, WIDTH_M } };
    static const enum distance_mode modes[] = { DISTANCE_EUCLIDEAN, DISTANCE_GEODESIC };
    struct direction_place place = { .weights = { 0.8f, 0.1f, 0.1f }, .normal = { 0, 0, 1 } };
    struct sensor_direction *said;
    struct direction found;
    write_model(c);
    write_plant(c, "", "", 1);
    write_directions(c, false);
    prep_case_expect(c, "$PLANT", 0);
    struct plant_in_use *u = use_prepared(c);
    const struct asset_view *view = &u->scene->assets[0].file->view;
    for (size_t i = 0; i < 4; i++) {
        say(u, "T", i, 5);
        say(u, "U", i, 3);
        say(u, "V", i, i == 0 ? 4 : -4);
        say(u, "W", i, 0);
    }
    for (int k = 0; k < 3; k++) {
        double best_m = INFINITY;
        for (uint32_t v = 0; v < view->header->vertex_count; v++) {
            double x_m = (double)view->positions_m[v][0] + view->header->origin_m[0] - ends[k][0];
            double away_m = hypot(x_m, (double)view->positions_m[v][1] + view->header->origin_m[1] - ends[k][1]);
            if (away_m < best_m)
                place.corners[k] = v;
            best_m = fmin(best_m, away_m);
        }
    }
    size_t count = directions_read(u->scene, 0, 0, u->snapshot, &said);
    for (int i = 0; i < 2; i++) {
        u->params.distance = modes[i];
        directions_find(&(struct direction_sources){ u->scene, 0, &u->params, said, count }, &place, 1, &found);
        print_message("%s: %.3f, %.3f\n", i ? "along the surface" : "straight", (double)found.along[0], (double)found.along[1]);
        expect_along(&found, 0.6, 0.8);
    }
    mem_free(said);
}

#define GP_KEYS ", interpolation: gp, gp: { range_m: 3, noise: 0.5, deviation: 30 }, disc_m: 0.1"

/* The gp field (Gaussian process) shows each sensor's reading at the sensor and follows when one changes. If a sensor is lost,
   it is as if computed from the others only. */
CASE(test_gp_meets_readings_and_lets_lost_ones_go)
{
    struct plant_in_use *u = begin(c, "", GP_KEYS, SENSORS);
    for (size_t i = 0; i < SENSORS; i++)
        assert_true(fabs((double)look(u, place_of(i))->value - 10.0 * (double)i) < 1);
    u->snapshot->readings[4].value = 90;
    look(u, 0);
    assert_true(fabs((double)look(u, place_of(4))->value - 90) < 1.5);
    u->params.fill = FILL_NEIGHBOURS;
    u->snapshot->readings[4] = (struct reading){ .value = 5000, .quality = QUALITY_BAD };
    assert_true(fabs((double)look(u, place_of(4))->value - 40) < 3);
    /* with gp, each vertex's weights sum to 1, so gp can also show the operator's view, which averages positions between alarm
       limits */
    u->params.show = SHOW_OPERATOR;
    assert_null(field_params_wrong(u->plant, &u->params));
}

/* The uncertainty that gp states depends on which sensors are good, not on what they read. It grows near a lost sensor and
   never exceeds the deviation given in the plant file (the prior). */
CASE(test_uncertainty_depends_on_who_is_good)
{
    double low, high;
    struct plant_in_use *u = begin(c, "", GP_KEYS, SENSORS);
    field_params_set_show(u->plant, &u->params, SHOW_UNCERTAINTY);
    field_default_range(u->scene, &u->params, &low, &high);
    assert_true(low == 0 && fabs(high - 30) < 1e-9);
    const double at_sensor = (double)look(u, place_of(4))->value, between = (double)look(u, place_of(4) + 0.4)->value;
    print_message("deviation: %.2f at a sensor, %.2f between two\n", at_sensor, between);
    assert_true(at_sensor < 1.5 && between > 1.2 * at_sensor && between < 15);
    uint64_t version = u->scalars->version;
    u->snapshot->readings[4].value = 12345;
    assert_true((double)look(u, place_of(4))->value == at_sensor && u->scalars->version == version);
    u->snapshot->readings[4].quality = QUALITY_BAD;
    const struct scalar *lost = look(u, place_of(4));
    assert_true((double)lost->value > 2 * between && (double)lost->value < 30 && lost->no_data == 255);
    u->snapshot->readings[4].quality = QUALITY_GOOD;
    assert_true((double)look(u, place_of(4))->value == at_sensor);
    u->params.interpolation = INTERPOLATION_SHEPARD;
    assert_non_null(strstr(field_params_wrong(u->plant, &u->params), "uncertainty needs the interpolation 'gp'"));
}

/* The gp field is unknown where the sensors reduce the variance of the prior by less than a tenth. */
CASE(test_gp_knows_how_far_it_sees)
{
    struct plant_in_use *u = begin(c, "", ", interpolation: gp, gp: { range_m: 0.8, noise: 0.5, deviation: 30 }, disc_m: 0.1", 2);
    assert_int_equal(look(u, place_of(1))->no_data, 0);
    assert_int_equal(look(u, 6)->no_data, 255);
}

static double predicted_of(const struct plant_in_use *u, size_t sensor, double *deviation)
{
    struct neighbours_cache cache = { 0 };
    const struct neighbours_kept *found = neighbours_look(&cache, u->scene, 0, 0, u->snapshot);
    assert_int_equal(found->count, u->plant->tag_count);
    assert_int_equal(found->list[sensor].tag, sensor);
    double predicted = found->list[sensor].predicted;
    *deviation = found->list[sensor].deviation;
    neighbours_cache_finish(&cache);
    return predicted;
}

/* neighbours_look() predicts a sensor from the others at most once per second, and gives the cached prediction to all callers
   in between. */
CASE(test_what_others_say_is_kept_for_a_second)
{
    struct neighbours_cache cache = { 0 };
    struct plant_in_use *u = begin(c, "", ", interpolation: gp, gp: { range_m: 0.8, noise: 0.5, deviation: 30 }, disc_m: 0.1", 2);
    u->snapshot->taken_mono_ns = 1;
    const struct neighbours_kept *kept = neighbours_look(&cache, u->scene, 0, 0, u->snapshot);
    double first = kept->list[0].value;
    u->snapshot->readings[0].value += 3;
    u->snapshot->taken_mono_ns += NEIGHBOURS_FRESH_NS - 1;
    assert_true(neighbours_look(&cache, u->scene, 0, 0, u->snapshot)->list[0].value == first);
    u->snapshot->taken_mono_ns++;
    kept = neighbours_look(&cache, u->scene, 0, 0, u->snapshot);
    assert_true(kept->list[0].value == first + 3 && kept->taken_mono_ns == u->snapshot->taken_mono_ns);
    neighbours_cache_finish(&cache);
}

/* The value that the other sensors predict for a sensor must not depend on its own reading or quality, also while one of the others is
   lost. */
CASE(test_others_do_not_hear_a_sensor_itself)
{
    static const char *const keys[] = { GP_KEYS, ", prepare: [harmonic], disc_m: 0.1", ", prepare: [fin], ambient: 20, disc_m: 0.1", "" };
    for (int k = 0; k < 4; k++) {
        double good, lost, deviation, other;
        struct plant_in_use *u = begin(c, ", thickness_m: 0.05", keys[k], SENSORS);
        for (int others = 0; others < 2; others++) {
            u->snapshot->readings[6].quality = others ? QUALITY_BAD : QUALITY_GOOD;
            u->snapshot->readings[7].quality = others ? QUALITY_BAD : QUALITY_GOOD;
            u->snapshot->readings[4] = (struct reading){ .value = 77, .quality = QUALITY_GOOD };
            good = predicted_of(u, 4, &deviation);
            u->snapshot->readings[4].value = -500;
            assert_true(fabs(predicted_of(u, 4, &other) - good) < 1e-6 * 500);
            u->snapshot->readings[4].quality = QUALITY_BAD;
            lost = predicted_of(u, 4, &other);
            assert_true(fabs(lost - good) < 1e-6 * 500);
            assert_true(k > 0 ? isnan(deviation) : fabs(other / deviation - 1) < 1e-6 && deviation > 0.5 && deviation < 30);
            if (k < 2)
                assert_true(fabs(good - 40) < (k ? 0.5 : 3)); /* straight between its neighbours */
        }
        for (size_t i = 0; i < SENSORS; i++)
            u->snapshot->readings[i].quality = i == 4 ? QUALITY_GOOD : QUALITY_BAD;
        assert_true(isnan(predicted_of(u, 4, &deviation)));
    }
}

/* Without a prepared interpolation, a sensor is predicted from all others, 0.8 m, 1.6 m and more away, weighted by 1 / D^2. */
CASE(test_others_by_distance)
{
    double sum = 0, whole = 0, deviation;
    struct plant_in_use *u = begin(c, "", "", SENSORS);
    for (size_t i = 0; i < SENSORS; i++) {
        double away = fabs(place_of(i) - place_of(4));
        sum += i == 4 ? 0 : 10.0 * (double)i / (away * away);
        whole += i == 4 ? 0 : 1 / (away * away);
    }
    assert_true(fabs(predicted_of(u, 4, &deviation) - sum / whole) < 1);
}

/* Blind spots: the map shows the height of the smallest hot spot, in degrees, that sensors would notice. It is a twentieth of
   the range (5) at a good sensor and grows with distance, by e^2 at two spot sizes. */
CASE(test_blind_places)
{
    double low, high;
    struct plant_in_use *u = begin(c, "", ", hot_spot_m: 0.2", SENSORS);
    u->params.show = SHOW_BLIND;
    field_default_range(u->scene, &u->params, &low, &high);
    assert_true(fabs(low - 5) < 1e-9 && fabs(high - 100) < 1e-9);
    assert_true(fabs((double)look(u, place_of(4))->value - 5) < 0.5);
    assert_true(fabs(log((double)look(u, place_of(4) + 0.4)->value / 5) - 2) < 0.5);
    u->snapshot->readings[4].quality = QUALITY_BAD;
    const struct scalar *lost = look(u, place_of(4));
    assert_true(fabs(log((double)lost->value / 5) - 8) < 1.2); /* four sizes from both neighbours */
    assert_int_equal(lost->no_data, 0);
    u->params.reach_m = 0.1; /* the group's reach, which limits the field, does not limit this map */
    assert_int_equal(look(u, place_of(4))->no_data, 0);
}

/* Far from its two sensors the gp field has no data, but the map of blind spots has. Where no sensor's position is known,
   neither has. */
CASE(test_blind_places_are_told_where_gp_knows_nothing)
{
    struct plant_in_use *u =
        begin(c, "", ", interpolation: gp, gp: { range_m: 0.8, noise: 0.5, deviation: 30 }, disc_m: 0.1, hot_spot_m: 0.2", 2);
    assert_true(look(u, STRIP_M - 0.5)->no_data);
    u->params.show = SHOW_BLIND;
    /* like the field itself, the map measures along the surface, even if the group has straight-line distances */
    struct field_params room;
    u->params.distance = DISTANCE_EUCLIDEAN;
    assert_int_equal(field_params_of(u->field, 0, &u->params, &room)->distance, DISTANCE_GEODESIC);
    assert_int_equal(look(u, STRIP_M - 0.5)->no_data, 0);
    assert_true(look(u, STRIP_M - 0.5)->value >= 100);
    assert_true(fabs((double)look(u, place_of(1))->value - 5) < 0.5);
    for (size_t i = 0; i < u->plant->tag_count; i++)
        u->plant->tags[i].place.assumed = true;
    field_destroy(&u->field);
    u->field = field_create(u->workers, u->scene);
    assert_null(field_scalars(u->field, 0, &u->params, u->snapshot));
    field_params_set_show(u->plant, &u->params, SHOW_UNCERTAINTY);
    assert_null(field_scalars(u->field, 0, &u->params, u->snapshot));
    field_params_set_show(u->plant, &u->params, SHOW_VALUE);
    assert_non_null(field_scalars(u->field, 0, &u->params, u->snapshot));
}

/* A strip with two sensors at one end: the first suggested new sensor must lie in the part that no sensor sees, and each
   further one must gain less. A brute-force search must find no position that gains noticeably more than the first. */
CASE(test_suggestions_gain_less_and_less)
{
    struct suggestion list[5];
    struct plant_in_use *u = begin(c, "", ", hot_spot_m: 0.4", 2);
    char *folder = test_memory(plant_prepared_folder(u->plant));
    struct suggest_query query = { the_log, u->workers, u->scene, folder, 0, -1, 5 };
    const double seen_m = 0.4 * sqrt(2 * log(20));
    assert_int_equal(sensor_suggest(&query, list), 5);
    double before = list[0].before, best = 0;
    for (size_t i = 0; i < 5; i++) {
        print_message("%.2f m: %.4f to %.4f, unseen %.3f to %.3f\n", list[i].at_m[0], list[i].before, list[i].after, list[i].unseen_before,
                      list[i].unseen_after);
        assert_true(list[i].before == before && list[i].after < before && list[i].unseen_after <= list[i].unseen_before);
        if (i > 0)
            assert_true(list[i].before - list[i].after <= 1.02 * (list[i - 1].before - list[i - 1].after));
        before = list[i].after;
    }
    assert_true(list[0].at_m[0] > place_of(1) + seen_m && list[0].at_m[0] < STRIP_M - seen_m / 2);
    for (double x = 0; x < STRIP_M; x += 0.05) { /* compares with a brute-force search of positions along a line */
        double gain = 0;
        for (double at = 0.005; at < STRIP_M; at += 0.01) {
            double near = fmin(fabs(at - place_of(0)), fabs(at - place_of(1))), now = fmin(near, fabs(at - x));
            gain += 0.01 / STRIP_M * (fmin(1, near * near / (seen_m * seen_m)) - fmin(1, now * now / (seen_m * seen_m)));
        }
        best = fmax(best, gain);
    }
    print_message("the best place gains %.4f, what was suggested %.4f\n", best, list[0].before - list[0].after);
    assert_true(fabs(list[0].before - list[0].after - best) < 0.03 * best);
    query.asset = 0;
    query.count = 1;
    assert_int_equal(sensor_suggest(&query, list), 1);
}

CASE(test_gp_bad_input)
{
    write_model(c);
    write_plant(c, "", ", prepare: [gp]", 2);
    prep_case_expect(c, "$PLANT", 1);
    prep_case_says(&c->err, "group temperature: gp requires 'gp: { range_m: ... }'");
    write_plant(c, "", ", prepare: [gp], gp: { range_m: 0, noise: -1 }", 2);
    prep_case_expect(c, "$PLANT", 1);
    prep_case_says(&c->err, "range_m");
    prep_case_says(&c->err, "noise");
    write_plant(c, "", ", prepare: [gp], gp: { fit: nothing.csv }", 3);
    prep_case_expect(c, "$PLANT", 1);
    prep_case_says(&c->err, "nothing.csv: cannot be read");
    write_plant(c, "", ", prepare: [gp], gp: { range_m: 0.001 }", 3);
    prep_case_expect(c, "$PLANT", 1);
    prep_case_says(&c->err, "range_m 0.001 of the Gaussian process (gp) is too short");
    write_plant(c, "", ", prepare: [gp], gp: { range_m: 100000, noise: 0 }", 3);
    prep_case_expect(c, "$PLANT", 0);
    struct plant_in_use *u = use_prepared(c);
    u->params.interpolation = INTERPOLATION_GP;
    for (size_t i = 0; i < 3; i++) {
        u->snapshot->readings[i].value = i == 1 ? 80 : 20;
        look(u, 0);
    }
    assert_true(fabs((double)look(u, place_of(1))->value - 80) < 2);
    /* weights prepared with other parameters of gp must not be used */
    write_plant(c, "", ", prepare: [gp], gp: { range_m: 90000, noise: 0 }", 3);
    assert_null(use(c));
}

/* Range, noise and deviation are fitted to the readings in a file; if the file changes, they are fitted again. */
CASE(test_gp_fitted_to_readings)
{
    struct text *rows = test_text();
    text_add(rows, "time,T0,T1,T2,T3\n");
    for (int t = 0; t < 40; t++)
        text_add(rows, "%d,%g,%g,%g,%g\n", t, 20 + 9 * sin(t), 20 + 8 * sin(t + 0.2), 20 + 8 * sin(t + 0.5), 20 + 9 * sin(t + 0.8));
    write_model(c);
    temp_write_text(c->folder, "readings.csv", rows->at);
    write_plant(c, "", ", interpolation: gp, gp: { fit: readings.csv }", 4);
    prep_case_expect(c, "$PLANT", 0);
    struct plant_in_use *u = use_prepared(c);
    const struct influence_entry *entry = influence_find(&u->scene->assets[0].file->influence, 0, INTERPOLATION_GP);
    print_message("fitted: range %.2f m, noise %.2f, deviation %.2f\n", entry->range_m, entry->noise, entry->deviation);
    assert_true(entry->range_m > 0.5 && entry->deviation > 0.5 && entry->deviation < 100 && entry->noise < 5);
    look(u, place_of(0));
    /* the file's columns belong to other sensors if two tags exchange their names */
    uint64_t key, exchanged;
    prep_case_file(c, ".influence", &key);
    prep_case_tags(c, "T1,400001,Float,plc,temperature,S,,0.5,0.05,0\nT0,400003,Float,plc,temperature,S,,1.3,0.05,0\n"
                      "T2,400005,Float,plc,temperature,S,,2.1,0.05,0\nT3,400007,Float,plc,temperature,S,,2.9,0.05,0\n");
    prep_case_expect(c, "$PLANT", 0);
    prep_case_file(c, ".influence", &exchanged);
    assert_true(exchanged != key);
    text_add(rows, "40,1,2\n");
    temp_write_text(c->folder, "readings.csv", "T0,T1\n");
    prep_case_expect(c, "$PLANT", 1);
    prep_case_says(&c->err, "line 1: no column 'T2'");
}

/* One or two sensors are too few for a fit: the asset uses the defaults, and the plant reports it. */
CASE(test_gp_of_few_sensors_takes_defaults)
{
    write_model(c);
    temp_write_text(c->folder, "readings.csv", "T0,T1\n");
    for (int sensors = 1; sensors <= 2; sensors++) {
        write_plant(c, "", ", prepare: [gp], gp: { fit: readings.csv }", sensors);
        prep_case_expect(c, "$PLANT", 0);
        prep_case_says(&c->err, "(gp) cannot be fitted");
        struct plant_in_use *u = use_prepared(c);
        const struct influence_entry *entry = influence_find(&u->scene->assets[0].file->influence, 0, INTERPOLATION_GP);
        const struct plant_group *group = &u->plant->groups[0];
        assert_true(fabs(entry->deviation - PLANT_GP_DEVIATION * (group->max - group->min)) < 1e-9);
        assert_true(fabs(entry->noise - PLANT_GP_NOISE * (group->max - group->min)) < 1e-9);
        assert_true(entry->range_m > 0);
    }
    write_plant_to(c, "1000", "", ", prepare: [gp], gp: { fit: readings.csv }", 2); /* the defaults depend on the range */
    assert_null(use(c));
    prep_case_expect(c, "$PLANT", 0);
    struct plant_in_use *u = use_prepared(c);
    assert_true(influence_find(&u->scene->assets[0].file->influence, 0, INTERPOLATION_GP)->deviation > PLANT_GP_DEVIATION * 900);
}

CASE(test_what_is_missing_is_said)
{
    write_model(c);
    write_plant(c, "", ", prepare: [harmonic, fin]", 2);
    prep_case_expect(c, "$PLANT", 1);
    prep_case_says(&c->err, "group temperature: fin requires 'ambient', the value around the assets, in K");
    prep_case_says(&c->err, "asset S: group temperature has 'interpolation: fin', which requires 'thickness_m'");
    write_plant(c, "", ", prepare: [kriging]", 2);
    prep_case_expect(c, "$PLANT", 1);
    prep_case_says(&c->err, "prepare: expected harmonic, fin or gp");
    write_plant(c, ", thickness_m: 0", ", prepare: [harmonic]", 2);
    prep_case_expect(c, "$PLANT", 1);
    prep_case_says(&c->err, "thickness_m");
}

CASE(test_not_prepared_is_refused)
{
    struct plant_in_use *u = begin(c, "", "", 2);
    u->params.interpolation = INTERPOLATION_HARMONIC;
    assert_non_null(strstr(field_params_wrong(u->plant, &u->params), "not prepared"));
    write_plant(c, "", ", prepare: [harmonic]", 2); /* the plant file asks for an interpolation that was not prepared */
    assert_null(use(c));
    prep_case_expect(c, "$PLANT", 0);
    u = use_prepared(c);
    write_plant(c, "", ", prepare: [harmonic], disc_m: 0.2", 2);
    assert_null(use(c));
}

/* Writes a plant with the groups A and B, each with two sensors. `groups`: the group of each sensor; order: the groups' ids as in the plant
   file. */
static void write_two_groups(struct prep_case *c, const char *keys, const char groups[4], const char order[2])
{
    struct text *rows = test_text();
    char *yaml = test_printf("plant: { name: Strip }\n"
                             "assets:\n"
                             "  - { id: S, model: model.glb, up: z }\n"
                             "groups:\n"
                             "  - { id: %c, unit: K, min: 0, max: 100%s }\n"
                             "  - { id: %c, unit: K, min: 0, max: 100%s }\n"
                             "sources:\n"
                             "  - { id: plc, type: modbus, host: 127.0.0.1, byte_order: CDAB, address_base: 1 }\n"
                             "tags: tags.csv\n",
                             order[0], keys, order[1], keys);
    for (size_t i = 0; i < 4; i++)
        text_add(rows, "T%zu,%zu,Float,plc,%c,S,,%g,0.05,0\n", i, 400001 + 2 * i, groups[i], place_of(i));
    prep_case_plant(c, yaml);
    prep_case_tags(c, rows->at);
}

/* Weights belong to the sensors for which they were prepared: the daemon refuses them for as many other sensors of the asset. */
CASE(test_weights_of_other_sensors_are_refused)
{
    static const char *const keys[] = { ", prepare: [harmonic]", ", geodesic: heat" };
    write_model(c);
    for (size_t i = 0; i < sizeof(keys) / sizeof(*keys); i++) {
        write_two_groups(c, keys[i], "AABB", "AB");
        prep_case_expect(c, "$PLANT", 0);
        use_prepared(c);
        write_two_groups(c, keys[i], "BAAB", "AB");
        assert_null(use(c));
        write_two_groups(c, keys[i], "AABB", "BA");
        assert_null(use(c));
        prep_case_expect(c, "$PLANT", 0);
        use_prepared(c);
    }
}

/* Returns the sum of the errors that picks state in the triangles of the first metre of the strip. */
static double stated_errors(struct plant_in_use *u)
{
    const struct asset_view *view = &u->scene->assets[0].file->view;
    double sum = 0;
    look(u, 0);
    for (uint32_t t = 0; t < view->primitives[0].index_count / 3; t++) {
        struct field_place place = { .parts = { 0.4, 0.3, 0.3 } };
        struct field_point point;
        bool is_near = true;
        for (int k = 0; k < 3; k++) {
            place.corners[k] = view->indices[3 * t + (uint32_t)k];
            const float *at_m = view->positions_m[place.corners[k]];
            is_near &= (double)at_m[0] + view->header->origin_m[0] < 1 && (double)at_m[1] + view->header->origin_m[1] < WIDTH_M + 0.01;
        }
        if (is_near && field_at(u->field, 0, &u->params, u->snapshot, &place, &point))
            sum += point.drawn_error;
    }
    return sum;
}

/* The lost sensor is the only one on the second of two bodies, so that no other sensor determines a value there. The stated errors of the
   first body stay the same. */
CASE(test_a_body_without_sensors_leaves_the_errors_of_others)
{
    struct cad_random random;
    struct cad *strip = test_cad(), *cad = test_cad();
    struct text *rows = test_text();
    cad_random_start(&random);
    cad_plate(strip, &random, 20, 1, STRIP_M, WIDTH_M, 0);
    cad_append(cad, strip, (double[3]){ 0 });
    cad_append(cad, strip, (double[3]){ 0, 5, 0 });
    maker_write_cad(c->folder, "model.glb", "strips", cad);
    write_plant(c, "", ", interpolation: harmonic, disc_m: 0.02", 0);
    for (size_t i = 0; i < 3; i++)
        text_add(rows, "T%zu,%zu,Float,plc,temperature,S,,%g,%g,0\n", i, 400001 + 2 * i, i == 0 ? 0.27 : 0.73, i < 2 ? 0.03 : 5.05);
    prep_case_tags(c, rows->at);
    prep_case_expect(c, "$PLANT", 0);
    struct plant_in_use *u = use_prepared(c);
    u->snapshot->readings[0].value = 70;
    u->snapshot->readings[1].value = 90;
    u->snapshot->readings[2].value = 80;
    const double before = stated_errors(u);
    u->snapshot->readings[2].quality = QUALITY_BAD;
    const double after = stated_errors(u);
    print_message("sum of the stated errors: %g before, %g after the loss\n", before, after);
    assert_true(before > 1 && fabs(after - before) < 0.01 * before);
}

enum { PLACES = 20000 };

struct painted_tally { /* places beyond the reach, those that a picture or a pick shows as data, and unmarked places within the reach */
    int beyond, painted, picked, within;
};

/* Compares random places in the triangles of the finest level with the distance from sensor 0. */
static void tally_painted(struct plant_in_use *u, double reach_m, struct painted_tally *tally)
{
    const struct asset_view *view = &u->scene->assets[0].file->view;
    for (int i = 0; i < PLACES; i++) {
        double lacking = 0, uncertain = 0, at_m[2] = { view->header->origin_m[0], view->header->origin_m[1] };
        struct field_place place = { .parts = { cad_random(&chance), cad_random(&chance) } };
        struct field_point point;
        uint32_t tri = (uint32_t)(cad_random(&chance) * (view->primitives[0].index_count / 3));
        if (place.parts[0] + place.parts[1] > 1)
            continue;
        place.parts[2] = 1 - place.parts[0] - place.parts[1];
        for (int k = 0; k < 3; k++) {
            place.corners[k] = view->indices[3 * tri + (uint32_t)k];
            for (int axis = 0; axis < 2; axis++)
                at_m[axis] += place.parts[k] * (double)view->positions_m[place.corners[k]][axis];
            lacking += place.parts[k] * (double)u->scalars->at[place.corners[k]].lacking;
            uncertain += place.parts[k] * (double)u->scalars->at[place.corners[k]].uncertain;
        }
        assert_true(field_at(u->field, 0, &u->params, u->snapshot, &place, &point));
        const double away_m = hypot(at_m[0] - place_of(0), at_m[1] - 0.05);
        const bool is_shown = lacking <= 127.5 && uncertain <= 127.5, is_beyond = away_m > reach_m + 0.1;
        tally->beyond += is_beyond;
        tally->painted += is_beyond && is_shown;
        tally->picked += is_beyond && !point.no_data;
        tally->within += away_m < reach_m - 0.1 && is_shown;
    }
}

/* Preparation does not cut the large triangles of a plate at the border of a lone sensor's reach. Beyond the border, pictures show no data,
   or mark the triangle. Small triangles within the reach are not marked. */
CASE(test_triangles_across_the_border_of_the_reach_are_marked)
{
    static const char *const keys[] = { ", interpolation: harmonic, disc_m: 0.05, reach_m: 1.2",
                                        ", interpolation: fin, ambient: 20, disc_m: 0.05, reach_m: 1.2" };
    for (int i = 0; i < 4; i++) {
        const int cells = i % 2 ? 40 : 2;
        struct painted_tally tally = { 0 };
        struct cad_random random;
        struct cad *cad = test_cad();
        cad_random_start(&random);
        cad_plate(cad, &random, cells, cells, STRIP_M, STRIP_M, 0);
        maker_write_cad(c->folder, "model.glb", "plate", cad);
        write_plant(c, ", thickness_m: 0.2", keys[i / 2], 1);
        prep_case_expect(c, "$PLANT", 0);
        struct plant_in_use *u = use_prepared(c);
        look(u, 0);
        tally_painted(u, 1.2, &tally);
        print_message("%d cells: %d places beyond the reach, %d painted, %d picked; %d places within it are unmarked\n", cells * cells,
                      tally.beyond, tally.painted, tally.picked, tally.within);
        assert_true(tally.beyond > 1000 && (cells == 2 || tally.within > 50));
        assert_int_equal(tally.painted, 0);
        assert_int_equal(tally.picked, 0);
    }
}

/* For an asset without sensors nothing is prepared, and no file is reported as missing. */
CASE(test_without_sensors_no_file_is_missed)
{
    write_model(c);
    write_plant(c, "", ", geodesic: heat", 0);
    prep_case_tags(c, "T0,400001,Float,plc,,,,,\n"); /* of no asset */
    prep_case_expect(c, "$PLANT", 0);
    FILE *said = tmpfile();
    int before = dup(STDERR_FILENO);
    assert_non_null(said);
    assert_true(before >= 0 && dup2(fileno(said), STDERR_FILENO) >= 0);
    bool good = use(c) != NULL;
    assert_true(dup2(before, STDERR_FILENO) >= 0);
    close(before);
    assert_true(good);
    assert_int_equal(lseek(fileno(said), 0, SEEK_END), 0);
    fclose(said);
}

/* A prepared file of weights that is missing or damaged must not be used, and plantcast-prep must make it again. */
CASE(test_damaged_file)
{
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
        assert_null(use(c));
        prep_case_expect(c, "$PLANT", 0);
        prep_case_says(&c->err, path);
        prep_case_says(&c->err, way ? "truncated: the file has 100 bytes, but its header says" : "damaged: its checksum");
        use_prepared(c);
    }
    write_plant(c, "", "", 2); /* after the interpolation was removed from the plant file, preparing deletes its file */
    prep_case_expect(c, "$PLANT", 0);
    assert_int_not_equal(access(path, F_OK), 0);
}

TEST_GROUP(surface_case_set_up, surface_case_tear_down)
