/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The operator view, which shows where each reading lies between the tag's alarm limits (its position: 0 in the middle, 1 at H, 2 at
   HH, negative towards L and LL). Tests positions, the field of positions, tags without limits, and alarms. */
#include "tests/support/test.h"

#include "field/field.h"
#include "field/limits.h"
#include "tests/support/synthetic.h"
#include "tests/support/whole_field.h"
#include "value/alarm.h"
#include "value/quality.h"

static const struct plant_group range_0_100 = { .min = 0, .max = 100 };

static struct plant_tag with_limits(double ll, double l, double h, double hh)
{
    return (struct plant_tag){ .alarms.limits = { ll, l, h, hh } };
}

static void expect(const struct plant_tag *tag, double value, double place)
{
    double got = limit_place(&range_0_100, tag, value);
    if (!(fabs(got - place) < 2e-3))
        fail_msg("%g with %g %g %g %g: %g, expected %g", value, tag->alarms.limits[0], tag->alarms.limits[1], tag->alarms.limits[2],
                 tag->alarms.limits[3], got, place);
}

TEST(test_all_limits)
{
    struct plant_tag tag = with_limits(10, 20, 60, 90);
    static const double values[][2] = { { 10, -2 }, { 20, -1 }, { 60, 1 }, { 90, 2 }, { 40, 0 }, { 50, 0.5 }, { 15, -1.5 }, { 75, 1.5 },
                                        { 120, 3 }, { 1e9, 3 }, { 0, -3 }, { -1e9, -3 }, { 105, 2.5 } };
    for (size_t i = 0; i < sizeof(values) / sizeof(*values); i++)
        expect(&tag, values[i][0], values[i][1]);
}

TEST(test_limits_that_are_missing)
{
    struct plant_tag high = with_limits(NAN, NAN, 80, 90), alone = with_limits(NAN, NAN, 80, NAN), last = with_limits(NAN, NAN, NAN, 80);
    expect(&high, 0, 0);
    expect(&high, 40, 0.5);
    expect(&high, 80, 1);
    expect(&high, 90, 2);
    expect(&high, -50, 0); /* this tag has no low limit, so no reading is too low: position 0 */
    expect(&alone, 80, 1);
    expect(&alone, 120, 1.5);
    expect(&alone, 500, 2); /* this tag has H but no HH: far beyond H the position approaches 2 (that of HH) without reaching it */
    assert_true(limit_place(&range_0_100, &alone, 500) < 2);
    expect(&last, 40, 0.5);
    assert_true(limit_place(&range_0_100, &last, 79.999) < 1); /* no limit is passed yet */
    expect(&last, 80, 2);
    expect(&last, 160, 2.5);
    struct plant_tag low = with_limits(10, 20, NAN, NAN), both = with_limits(NAN, 20, 60, NAN), beyond = with_limits(NAN, NAN, -10, NAN);
    expect(&low, 100, 0);
    expect(&low, 60, -0.5);
    expect(&low, 20, -1);
    expect(&low, 10, -2);
    expect(&both, 40, 0);
    expect(&both, 20, -1);
    expect(&both, -10, -2.5 + 0.501); /* cut */
    expect(&beyond, -60, 0);          /* this tag's limit H is below MIN: position 0 is then half the range below H */
    expect(&beyond, -10, 1);
    struct plant_tag none = with_limits(NAN, NAN, NAN, NAN);
    assert_true(isnan(limit_place(&range_0_100, &none, 5)));
}

TEST(test_places_rise_with_readings)
{
    uint64_t random = 7;
    for (int i = 0; i < 300; i++) {
        double limits[LIMIT_COUNT], at = -50;
        for (int k = 0; k < LIMIT_COUNT; k++) {
            at += 1 + 40 * synthetic_random_unit(&random);
            limits[k] = synthetic_random(&random) % 3 ? at : (double)NAN;
        }
        struct plant_tag tag = with_limits(limits[0], limits[1], limits[2], limits[3]);
        if (isnan(limit_place(&range_0_100, &tag, 0)))
            continue;
        double before = -4;
        for (double value = -200; value <= 300; value += 0.25) {
            double place = limit_place(&range_0_100, &tag, value);
            assert_true(place >= before - 1e-12 && fabs(place) <= 3);
            struct reading reading = { .value = value };
            /* the alarm that results from the limits must agree with the position, which determines the colour */
            enum alarm_kind alarm = alarm_beyond(&tag, &reading);
            assert_int_equal(alarm == ALARM_HH, place >= 2 - 1e-9 && isfinite(limits[LIMIT_HH]));
            assert_int_equal(alarm == ALARM_LL, place <= -2 + 1e-9 && isfinite(limits[LIMIT_LL]));
            assert_int_equal(alarm == ALARM_NONE, fabs(place) < 1 - 1e-9);
            before = place;
        }
    }
}

TEST(test_alarms_need_usable_readings)
{
    struct plant_tag tag = with_limits(NAN, 20, 60, 90);
    struct reading reading = { .value = 95 };
    assert_int_equal(alarm_beyond(&tag, &reading), ALARM_HH);
    reading.value = 60;
    assert_int_equal(alarm_beyond(&tag, &reading), ALARM_H);
    reading.value = 1;
    assert_int_equal(alarm_beyond(&tag, &reading), ALARM_L);
    /* a reading beyond the instrument's range is Uncertain, but still counts as beyond its limits */
    reading.quality = QUALITY_UNCERTAIN_UNITS_EXCEEDED;
    assert_int_equal(alarm_beyond(&tag, &reading), ALARM_L);
    reading.quality = QUALITY_BAD_SENSOR_FAILURE;
    assert_int_equal(alarm_beyond(&tag, &reading), ALARM_NONE);
    assert_null(alarm_kind_name(ALARM_NONE));
}

/* --- the field of the positions between limits -------------------------------------------------------------------------------- */

enum { SENSORS = 6, VERTICES = 400 };

static void set_limits(struct synthetic *plant, size_t tag, double low, double high)
{
    double range = high - low;
    memcpy(plant->plant.tags[tag].alarms.limits, (double[]){ low - range, low, high, high + range },
           sizeof(plant->plant.tags[tag].alarms.limits));
}

/* Sets random positions from least_place to most_place. The field of positions of a plant with limits must equal the field of a
   plant without limits whose readings are these positions. */
static void compare(enum interpolation interpolation, double least_place, double most_place)
{
    struct synthetic *places = synthetic_create(.vertices = VERTICES, .sensors = SENSORS, .max = 1);
    struct synthetic *plant = synthetic_create(.vertices = VERTICES, .sensors = SENSORS, .max = 100);
    struct workers *workers = workers_create(1);
    struct field *field = field_create(workers, &plant->scene), *truth = field_create(workers, &places->scene);
    uint64_t random = 11;
    for (size_t i = 0; i < SENSORS; i++) {
        double place = least_place + (most_place - least_place) * synthetic_random_unit(&random);
        /* each tag has other limits, L and H = L + 4; the middle between them is L + 2 */
        set_limits(plant, i, 10 * (double)i, 10 * (double)i + 4);
        double from_middle = fabs(place) <= 1 ? 2 * place : copysign(2 + 4 * (fabs(place) - 1), place);
        plant->snapshot->readings[i].value = 10 * (double)i + 2 + from_middle;
        places->snapshot->readings[i].value = place;
    }
    struct field_params params, plain;
    field_params_default(&plant->plant, 0, &params);
    params.interpolation = interpolation;
    plain = params;
    params.show = SHOW_OPERATOR;
    const struct scalars *got = field_scalars(field, 0, &params, plant->snapshot);
    const struct scalars *want = field_scalars(truth, 0, &plain, places->snapshot);
    for (size_t j = 0; j < VERTICES; j++) {
        assert_true(fabsf(got->at[j].value - want->at[j].value) < 1e-4f);
        assert_true(!got->at[j].no_data && !got->at[j].no_limits);
    }
    field_destroy(&field);
    field_destroy(&truth);
    workers_destroy(&workers);
    synthetic_destroy(&plant);
    synthetic_destroy(&places);
}

TEST(test_places_are_interpolated_with_the_same_weights)
{
    compare(INTERPOLATION_SHEPARD, -2.5, 2.5);
    /* only positions from 0 to 1 (from the middle to H), because the plant of the reference has this range and would clamp
       others */
    compare(INTERPOLATION_PAPER, 0, 1);
}

TEST(test_tags_without_limits_have_no_place)
{
    struct synthetic *plant = synthetic_create(.vertices = VERTICES, .sensors = 3, .max = 100);
    struct workers *workers = test_workers(1);
    struct field *field = field_create(workers, &plant->scene);
    for (size_t i = 0; i < 3; i++)
        set_limits(plant, i, 40, 60);
    for (int i = 0; i < LIMIT_COUNT; i++)
        plant->plant.tags[1].alarms.limits[i] = NAN;
    plant->snapshot->readings[0].value = 60;
    plant->snapshot->readings[1].value = 1e6; /* a huge reading of the tag without limits must not affect the field of positions */
    plant->snapshot->readings[2].value = 60;
    struct field_params params;
    field_params_default(&plant->plant, 0, &params);
    params.show = SHOW_OPERATOR;
    const struct scalars *scalars = field_scalars(field, 0, &params, plant->snapshot);
    size_t without = 0;
    for (size_t j = 0; j < VERTICES; j++) {
        assert_true(fabsf(scalars->at[j].value - 1) < 1e-5f && !scalars->at[j].no_data);
        without += scalars->at[j].no_limits != 0;
    }
    assert_true(scalars->at[1].no_limits && !scalars->at[0].no_limits && !scalars->at[2].no_limits); /* at the sensors */
    assert_true(without > 10 && without < VERTICES - 10);
    plant->snapshot->readings[1].quality = QUALITY_BAD_SENSOR_FAILURE; /* now nothing is known there */
    scalars = field_scalars(field, 0, &params, plant->snapshot);
    assert_true(scalars->at[1].no_data && !scalars->at[1].no_limits);
    params.show = SHOW_VALUE; /* when the field shows values, limits must have no effect */
    plant->snapshot->readings[1].quality = QUALITY_GOOD;
    scalars = field_scalars(field, 0, &params, plant->snapshot);
    assert_true(!scalars->at[1].no_limits && fabsf(scalars->at[1].value - 1e6f) < 1);
    field_destroy(&field);
    synthetic_destroy(&plant);
}
