/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The field (values at vertices, interpolated from readings): compared with plain loops in double precision, and tests of each
   rule by which updates and caches keep it exact. */
#include "tests/support/test.h"
#include <malloc.h>

#include "field/field.h"
#include "protocol/asset_distance.h"
#include "tests/support/synthetic.h"
#include "tests/support/whole_field.h"
#include "value/quality.h"

/* --- slow truth ----------------------------------------------------------------------------------------------------------- */

struct vertex_truth {
    double value;
    bool no_data, uncertain;
    /* true: rounding of floats may change whether the vertex has data or is uncertain, so these two flags are not compared */
    bool near_tie;
};

#define MAX_SENSORS 4096
struct vertex_sight { /* the configured sensors as seen from one vertex: distance, weight, and whether each sensor counts */
    double distance_m[MAX_SENSORS], weight[MAX_SENSORS], term[MAX_SENSORS];
    bool usable[MAX_SENSORS], configured[MAX_SENSORS];
};

static double truth_distance(const struct synthetic *plant, const struct field_params *params, size_t sensor, size_t vertex)
{
    const struct asset_view *view = &plant->file.view;
    if (params->distance == DISTANCE_GEODESIC)
        return (double)asset_distance_m(view, sensor, vertex);
    double sum = 0;
    for (int axis = 0; axis < 3; axis++) {
        double d = (double)view->sensors[sensor].surface_m[axis] - (double)view->positions_m[vertex][axis];
        sum += d * d;
    }
    return sqrt(sum);
}

static double truth_radius(const struct synthetic *plant, const struct field_params *params)
{
    double most = 0;
    if (params->radius_m > 0)
        return params->radius_m;
    for (size_t i = 0; i < plant->scene.assets[0].sensor_count; i++)
        for (size_t j = 0; j < plant->file.view.header->vertex_count; j++) {
            double d = truth_distance(plant, params, i, j);
            if (isfinite(d) && d > most)
                most = d;
        }
    return most;
}

/* Returns the factor by which a sensor's weight is reduced because the vertex is close to the sensor's reach. The nearest
   sensor has the factor 1. */
static double faded(const struct field_params *params, double near_m, double distance_m)
{
    if (isinf(params->reach_m) || distance_m <= near_m)
        return 1;
    return pow((1 - distance_m / params->reach_m) / (1 - near_m / params->reach_m), 2);
}

/* Sets weight[] for all sensors that reach the vertex, or for the nearest one if none does. */
static void truth_weights(struct vertex_sight *s, size_t count, const struct plant_tag *tags, const struct field_params *params,
                          double near_m, double radius_m)
{
    double limit_m = fmax(near_m, params->reach_m);
    bool at_sensor = false;
    double top = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        bool in = s->usable[i] && isfinite(s->distance_m[i]) && s->distance_m[i] <= limit_m;
        double d = fmax(0, 1 - s->distance_m[i] / radius_m);
        at_sensor |= in && s->distance_m[i] == 0;
        if (in)
            top = fmax(top, d * tags[i].strength * params->strength);
    }
    for (size_t i = 0; i < count; i++) {
        s->weight[i] = s->term[i] = 0;
        if (!s->usable[i] || !isfinite(s->distance_m[i]) || s->distance_m[i] > limit_m)
            continue;
        if (params->interpolation == INTERPOLATION_PAPER) {
            double d = fmax(0, 1 - s->distance_m[i] / radius_m);
            s->weight[i] = exp(d * tags[i].strength * params->strength - top);
            s->term[i] = s->weight[i] * pow(d, tags[i].decay * params->decay);
        } else if (at_sensor) {
            s->weight[i] = s->term[i] = s->distance_m[i] == 0 ? tags[i].strength : 0;
        } else {
            s->weight[i] = s->term[i] = tags[i].strength / pow(s->distance_m[i], params->power);
        }
        s->weight[i] *= faded(params, near_m, s->distance_m[i]);
        s->term[i] *= faded(params, near_m, s->distance_m[i]);
    }
}

static struct vertex_truth truth_at(const struct synthetic *plant, const struct field_params *params, double radius_m, size_t vertex)
{
    static struct vertex_sight s;
    size_t count = plant->scene.assets[0].sensor_count;
    bool paper = params->interpolation == INTERPOLATION_PAPER;
    double nearest_usable = INFINITY, nearest_configured = INFINITY, sum = 0, total = 0, uncertain = 0;
    for (size_t i = 0; i < count; i++) {
        const struct reading *r = &plant->snapshot->readings[i];
        s.distance_m[i] = truth_distance(plant, params, i, vertex);
        s.configured[i] = paper || plant->plant.tags[i].strength > 0;
        s.usable[i] = s.configured[i] && !quality_is_bad(r->quality) && isfinite(r->value);
        if (s.configured[i])
            nearest_configured = fmin(nearest_configured, s.distance_m[i]);
        if (s.usable[i])
            nearest_usable = fmin(nearest_usable, s.distance_m[i]);
    }
    bool reached = isfinite(nearest_usable) && nearest_usable <= params->reach_m, lost = nearest_configured < nearest_usable;
    struct vertex_truth truth = { .value = plant->group.min, .no_data = !reached || (lost && params->fill == FILL_NONE) };
    truth.near_tie = fabs(nearest_usable - params->reach_m) < 1e-5;
    truth_weights(&s, count, plant->plant.tags, params, nearest_usable, radius_m);
    for (size_t i = 0; i < count; i++) {
        const struct reading *r = &plant->snapshot->readings[i];
        if (s.weight[i] == 0)
            continue;
        double unit = fmin(fmax((r->value - plant->group.min) / (plant->group.max - plant->group.min), 0), 1);
        sum += s.term[i] * (paper ? unit : r->value);
        total += s.weight[i];
        uncertain += quality_is_uncertain(r->quality) ? s.weight[i] : 0;
        truth.near_tie |= s.distance_m[i] > params->reach_m - 1e-5;
        bool at_the_rim = s.distance_m[i] > nearest_usable && nearest_usable > 0.999 * params->reach_m; /* both have hardly any weight */
        truth.near_tie |= at_the_rim && s.distance_m[i] < params->reach_m;
        /* just inside the radius R, 1 - d/R is mostly rounding error, which a small power enlarges: does not compare such
           vertices */
        truth.near_tie |= paper && fabs(s.distance_m[i] - radius_m) < 1e-4 * radius_m;
    }
    for (size_t i = 0; i < count; i++) {
        truth.near_tie |= fabs(s.distance_m[i] - params->reach_m) < 1e-5;
        truth.near_tie |= s.configured[i] && !s.usable[i] && fabs(s.distance_m[i] - nearest_usable) < 1e-5;
    }
    if (total > 0)
        truth.value = paper ? plant->group.min + (plant->group.max - plant->group.min) * sum / total : sum / total;
    truth.near_tie |= total > 0 && fabs(2 * uncertain - total) < 1e-4 * total && uncertain != total / 2;
    truth.uncertain = (total > 0 && uncertain >= total / 2 && uncertain > 0) || (reached && lost && params->fill == FILL_NEIGHBOURS);
    return truth;
}

/* --- helpers -------------------------------------------------------------------------------------------------------------- */

static struct workers *workers;

struct field_rig {
    struct synthetic *plant;
    struct field *field;
    struct field_params params;
};

static void rig_destroy(void *resource)
{
    struct field_rig *rig = resource;
    field_destroy(&rig->field);
    synthetic_destroy(&rig->plant);
    mem_free(rig);
}

/* Returns a rig, which takes ownership of the plant. Both are freed automatically after the test. */
static struct field_rig *rig_create(struct synthetic *plant)
{
    struct field_rig *rig = mem_new(sizeof(*rig));
    *rig = (struct field_rig){ .plant = plant, .field = field_create(workers, &plant->scene) };
    field_params_default(&plant->plant, 0, &rig->params);
    owned_add(rig_destroy, rig);
    return rig;
}

static const struct scalars *show(const struct field_rig *rig)
{
    const struct scalars *scalars = field_scalars(rig->field, 0, &rig->params, rig->plant->snapshot);
    assert_non_null(scalars);
    return scalars;
}

static void set(const struct field_rig *rig, size_t sensor, double value, uint32_t quality)
{
    rig->plant->snapshot->readings[sensor].value = value;
    rig->plant->snapshot->readings[sensor].quality = quality;
}

static void assert_all_finite(const struct scalars *scalars)
{
    for (size_t j = 0; j < scalars->count; j++)
        assert_true(isfinite(scalars->at[j].value));
}

/* Asserts that this field, which has been updated step by step, has the same bits as a new field computed from the present
   readings. */
static void assert_as_fresh(const struct field_rig *rig)
{
    struct field *fresh = field_create(workers, &rig->plant->scene);
    const struct scalars *want = field_scalars(fresh, 0, &rig->params, rig->plant->snapshot), *got = show(rig);
    assert_memory_equal(got->at, want->at, want->count * sizeof(*want->at));
    assert_int_equal(got->oldest_age_ns, want->oldest_age_ns);
    field_destroy(&fresh);
}

static void assert_true_field(const struct field_rig *rig, double tolerance)
{
    const struct scalars *scalars = show(rig);
    double range = rig->plant->group.max - rig->plant->group.min, radius_m = truth_radius(rig->plant, &rig->params);
    for (size_t j = 0; j < scalars->count; j++) {
        struct vertex_truth truth = truth_at(rig->plant, &rig->params, radius_m, j);
        if (truth.near_tie)
            continue;
        assert_int_equal(scalars->at[j].lacking > 127, scalars->at[j].no_data > 0);
        if (fabs((double)scalars->at[j].value - truth.value) > tolerance * range || !scalars->at[j].no_data != !truth.no_data ||
            (scalars->at[j].uncertain > 127) != truth.uncertain)
            fail_msg("vertex %zu: %g no_data %d uncertain %d, truth %g %d %d", j, (double)scalars->at[j].value, scalars->at[j].no_data,
                     scalars->at[j].uncertain, truth.value, truth.no_data, truth.uncertain);
    }
}

static double between(uint64_t *random, double low, double high)
{
    return low + (high - low) * synthetic_random_unit(random);
}

/* --- against the truth ---------------------------------------------------------------------------------------------------- */

TEST(test_worked_example_of_the_paper)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 300, .sensors = 2, .max = 1));
    rig->params.interpolation = INTERPOLATION_PAPER;
    rig->params.radius_m = 10;
    synthetic_set_distance(rig->plant, 0, 7, 1); /* d = 0.9 */
    synthetic_set_distance(rig->plant, 1, 7, 8); /* d = 0.2 */
    set(rig, 0, 0.8, QUALITY_GOOD);
    set(rig, 1, 0.3, QUALITY_GOOD);
    double value = (double)show(rig)->at[7].value;
    double w0 = exp(0.9) / (exp(0.9) + exp(0.2)), w1 = 1 - w0;
    assert_true(fabs(value - 0.501) < 0.0005);
    assert_true(fabs(value - (0.8 * w0 * 0.9 + 0.3 * w1 * 0.2)) < 1e-6);
}

static void randomize(struct field_rig *rig, uint64_t *random)
{
    struct field_params *p = &rig->params;
    p->interpolation = synthetic_random(random) % 2 ? INTERPOLATION_PAPER : INTERPOLATION_SHEPARD;
    p->distance = synthetic_random(random) % 2 ? DISTANCE_EUCLIDEAN : DISTANCE_GEODESIC;
    p->fill = synthetic_random(random) % 2 ? FILL_NEIGHBOURS : FILL_NONE;
    p->strength = synthetic_random(random) % 3 ? between(random, 0, 4) : 1;
    p->decay = synthetic_random(random) % 3 ? between(random, 0, 3) : synthetic_random(random) % 2;
    p->power = synthetic_random(random) % 3 ? between(random, 0.5, 6) : 2;
    p->radius_m = synthetic_random(random) % 2 ? 0 : between(random, 2, 20);
    p->reach_m = synthetic_random(random) % 3 ? (double)INFINITY : between(random, 1, 8);
    size_t mood = synthetic_random(random) % 4; /* chooses how likely each sensor is Bad: 0, 1/4, 1/2 or 3/4 */
    for (size_t i = 0; i < rig->plant->scene.assets[0].sensor_count; i++) {
        double dice = synthetic_random_unit(random);
        rig->plant->plant.tags[i].strength = dice < 0.5 ? 1 : between(random, 0, 2);
        rig->plant->plant.tags[i].decay = dice < 0.5 ? 1 : between(random, 0, 2);
        uint32_t quality = synthetic_random(random) % 4 < mood ? QUALITY_BAD_SENSOR_FAILURE : QUALITY_GOOD;
        if (quality == QUALITY_GOOD && dice < 0.3)
            quality = QUALITY_UNCERTAIN_LAST_USABLE;
        set(rig, i, between(random, -20, 120), quality);
    }
}

TEST(test_random_input_is_as_plain_loops_say)
{
    uint64_t seed = sweep_seed(), random = seed;
    for (int round = 0; round < 60; round++) {
        size_t sensors = 1 + synthetic_random(&random) % 24, vertices = 260 + synthetic_random(&random) % 600;
        struct synthetic *plant = synthetic_create(.vertices = vertices, .sensors = sensors, .island = 10, .seed = seed + (uint64_t)round);
        struct field_rig *rig = rig_create(plant);
        randomize(rig, &random);
        assert_true_field(rig, 1e-4);
        for (int change = 0; change < 4; change++) {
            set(rig, synthetic_random(&random) % sensors, between(&random, -20, 120), QUALITY_GOOD);
            assert_true_field(rig, 1e-4);
        }
    }
}

TEST(test_extreme_parameters)
{
    uint64_t random = sweep_seed();
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 1500, .sensors = 9, .seed = random));
    const double powers[] = { 0.5, 2, 16 }, strengths[] = { 0, 1, 100 };
    for (int i = 0; i < 3; i++)
        for (int bad = 0; bad < 2; bad++)
            for (int fill = 0; fill < 2; fill++) {
                set(rig, 3, 95, bad ? QUALITY_BAD_NO_COMMUNICATION : QUALITY_GOOD);
                rig->params.fill = fill ? FILL_NEIGHBOURS : FILL_NONE;
                rig->params.interpolation = INTERPOLATION_SHEPARD;
                rig->params.power = powers[i];
                assert_true_field(rig, 1e-4);
                rig->params.interpolation = INTERPOLATION_PAPER;
                rig->params.strength = strengths[i];
                rig->params.decay = strengths[i];
                assert_true_field(rig, 1e-3);
            }
}

/* 4,096 sensors, every seventh one lost, with every interpolation. There must be no data at a lost sensor; with shepard, the
   other sensors' positions must show their own readings. Other cases are compared with plain loops. */
TEST(test_4096_sensors)
{
    uint64_t random = sweep_seed();
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 4400, .sensors = 4096, .seed = random));
    for (size_t i = 0; i < 4096; i += 7)
        set(rig, i, 1e3, QUALITY_BAD_SENSOR_FAILURE);
    for (int way = 0; way < 4; way++) {
        rig->params.interpolation = way & 1 ? INTERPOLATION_PAPER : INTERPOLATION_SHEPARD;
        rig->params.distance = way & 2 ? DISTANCE_EUCLIDEAN : DISTANCE_GEODESIC;
        const struct scalars *scalars = show(rig);
        for (size_t i = 0; i < 4096; i++) {
            assert_int_equal(scalars->at[i].no_data, i % 7 ? 0 : 255);
            assert_true(i % 7 == 0 || way & 1 || scalars->at[i].value == (float)rig->plant->snapshot->readings[i].value);
        }
        double radius_m = truth_radius(rig->plant, &rig->params);
        for (size_t j = 4096; j < 4400; j++) {
            struct vertex_truth truth = truth_at(rig->plant, &rig->params, radius_m, j);
            assert_true(fabs((double)scalars->at[j].value - truth.value) < 1e-3);
            assert_true(truth.near_tie || !scalars->at[j].no_data == !truth.no_data);
        }
    }
}

/* --- truth rules ---------------------------------------------------------------------------------------------------------- */

TEST(test_exact_at_the_sensor)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 700, .sensors = 12, .seed = sweep_seed()));
    const double powers[] = { 0.5, 1, 2, 3.7, 16 };
    for (int k = 0; k < 5; k++)
        for (int mode = 0; mode < 2; mode++) {
            rig->params.power = powers[k];
            rig->params.distance = mode ? DISTANCE_EUCLIDEAN : DISTANCE_GEODESIC;
            for (size_t i = 0; i < 12; i++) {
                rig->plant->plant.tags[i].strength = 0.3 + 0.17 * (double)i;
                set(rig, i, 0.1 + 7.3 * (double)i, QUALITY_GOOD);
            }
            for (size_t i = 0; i < 12; i++)
                assert_true(show(rig)->at[i].value == (float)(0.1 + 7.3 * (double)i));
            set(rig, 5, 1e5, QUALITY_GOOD); /* changes a single column */
            set(rig, 5, 33.3, QUALITY_GOOD);
            for (size_t i = 0; i < 12; i++)
                assert_true(show(rig)->at[i].value == (float)(i == 5 ? 33.3 : 0.1 + 7.3 * (double)i));
        }
}

TEST(test_two_sensors_at_one_place_are_averaged)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 300, .sensors = 3));
    for (size_t v = 0; v < 300; v++)
        synthetic_set_distance(rig->plant, 1, v, asset_distance_m(&rig->plant->file.view, 0, v));
    rig->plant->plant.tags[1].strength = 3;
    set(rig, 0, 10, QUALITY_GOOD);
    set(rig, 1, 30, QUALITY_GOOD);
    assert_true(fabsf(show(rig)->at[0].value - 25) < 1e-4f);
}

TEST(test_losing_the_hottest_is_not_painted_over)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 2000, .sensors = 5, .seed = sweep_seed()));
    for (size_t i = 0; i < 5; i++)
        set(rig, i, i == 2 ? 95 : 20, i == 2 ? QUALITY_BAD_SENSOR_FAILURE : QUALITY_GOOD);
    for (int way = 0; way < 4; way++) {
        bool fill = way & 1, paper = way & 2;
        rig->params.fill = fill ? FILL_NEIGHBOURS : FILL_NONE;
        rig->params.interpolation = paper ? INTERPOLATION_PAPER : INTERPOLATION_SHEPARD;
        const struct scalars *scalars = show(rig);
        size_t lost = 0;
        for (size_t j = 0; j < scalars->count; j++) {
            size_t nearest = 0;
            for (size_t i = 1; i < 5; i++) {
                float least_m = asset_distance_m(&rig->plant->file.view, nearest, j), m = asset_distance_m(&rig->plant->file.view, i, j);
                /* the nearest sensor decides; if sensor 2, which is lost, and another one are equally near, the other one does
                   */
                if (m < least_m || (m == least_m && nearest == 2))
                    nearest = i;
            }
            lost += nearest == 2;
            assert_int_equal(scalars->at[j].no_data, nearest == 2 && !fill ? 255 : 0);
            assert_int_equal(scalars->at[j].uncertain > 127, nearest == 2 && fill);
            assert_true(paper ? scalars->at[j].value < 20 + 1e-3f : fabsf(scalars->at[j].value - 20) < 1e-3f); /* nothing of the lost 95 */
        }
        assert_true(lost > 20);
        assert_int_equal(scalars->at[2].no_data, fill ? 0 : 255);
    }
}

TEST(test_a_good_twin_keeps_the_place)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 300, .sensors = 3));
    for (size_t v = 0; v < 300; v++)
        synthetic_set_distance(rig->plant, 1, v, asset_distance_m(&rig->plant->file.view, 0, v));
    set(rig, 0, 50, QUALITY_BAD_SENSOR_FAILURE);
    set(rig, 1, 60, QUALITY_GOOD);
    const struct scalars *scalars = show(rig);
    for (size_t j = 0; j < scalars->count; j++)
        assert_int_equal(scalars->at[j].no_data, 0);
    assert_true(scalars->at[0].value == 60);
}

TEST(test_zero_is_a_reading)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 300, .sensors = 2, .min = -10, .max = 10));
    set(rig, 0, 0.0, QUALITY_GOOD);
    set(rig, 1, 8, QUALITY_GOOD);
    const struct scalars *scalars = show(rig);
    assert_true(scalars->at[0].value == 0 && scalars->at[0].no_data == 0);
    rig->params.power = 0.5;
    assert_true(show(rig)->at[0].value == 0);
    rig->params.power = 2;
    scalars = show(rig);
    for (size_t j = 2; j < scalars->count; j++)
        assert_true(scalars->at[j].value > 0 && scalars->at[j].value < 8);
    set(rig, 1, 0.0, QUALITY_GOOD);
    for (size_t j = 0; j < scalars->count; j++)
        assert_true(show(rig)->at[j].value == 0 && !scalars->at[j].no_data);
}

TEST(test_all_bad_is_no_data)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 700, .sensors = 6, .min = 20, .max = 90));
    for (int paper = 0; paper < 2; paper++)
        for (int fill = 0; fill < 2; fill++) {
            rig->params.interpolation = paper ? INTERPOLATION_PAPER : INTERPOLATION_SHEPARD;
            rig->params.fill = fill ? FILL_NEIGHBOURS : FILL_NONE;
            for (size_t i = 0; i < 6; i++)
                set(rig, i, 70, QUALITY_BAD_NO_COMMUNICATION);
            const struct scalars *scalars = show(rig);
            assert_true(scalars->oldest_age_ns == INT64_MAX);
            for (size_t j = 0; j < scalars->count; j++)
                assert_true(scalars->at[j].no_data == 255 && scalars->at[j].uncertain == 0 && scalars->at[j].value == 20);
        }
}

TEST(test_one_sensor_is_everywhere)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 700, .sensors = 1));
    set(rig, 0, 41.7, QUALITY_GOOD);
    const struct scalars *scalars = show(rig);
    for (size_t j = 0; j < scalars->count; j++)
        assert_true(scalars->at[j].value == 41.7f && !scalars->at[j].no_data && !scalars->at[j].uncertain);
}

static void assert_even(const struct field_rig *rig, float value)
{
    const struct scalars *scalars = show(rig);
    for (size_t j = 0; j < scalars->count; j++)
        if (scalars->at[j].value != value || scalars->at[j].no_data || scalars->at[j].lacking || scalars->at[j].uncertain)
            fail_msg("vertex %zu of %zu: %g, no data %d", j, scalars->count, (double)scalars->at[j].value, scalars->at[j].no_data);
}

/* If the only sensor's position is assumed, the whole asset must show its reading, whatever interpolation, distance and reach
   the group or the user has chosen. */
TEST(test_an_assumed_place_is_the_whole_asset_evenly)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 700, .sensors = 1, .island = 100));
    rig->plant->plant.tags[0].place.assumed = true;
    rig->plant->plant.tags[0].strength = 0;
    set(rig, 0, 41.7, QUALITY_GOOD);
    for (int i = 0; i < 4; i++) {
        rig->params.interpolation = i & 1 ? INTERPOLATION_PAPER : INTERPOLATION_SHEPARD;
        rig->params.distance = i & 2 ? DISTANCE_GEODESIC : DISTANCE_EUCLIDEAN;
        rig->params.reach_m = 0.1;
        assert_even(rig, 41.7f);
        assert_true(field_is_assumed(rig->field, 0, &rig->params));
    }
    rig->params.show = SHOW_DISTANCE;
    rig->params.sensor = 0;
    assert_null(field_scalars(rig->field, 0, &rig->params, rig->plant->snapshot));
    assert_false(field_covers(rig->field, 0, &rig->params));
}

TEST(test_of_assumed_places_the_nearest_to_trouble_stands_for_all)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 700, .sensors = 3));
    for (int i = 0; i < 3; i++) {
        rig->plant->plant.tags[i].place.assumed = true;
        for (int limit = 0; limit < LIMIT_COUNT; limit++)
            rig->plant->plant.tags[i].alarms.limits[limit] = NAN;
    }
    set(rig, 0, 40, QUALITY_GOOD);
    set(rig, 1, 75, QUALITY_GOOD);
    set(rig, 2, 30, QUALITY_GOOD);
    /* of three readings (40, 75, 30), the asset shows the one farthest from the middle of the range 0 to 100: 75 */
    assert_even(rig, 75);
    set(rig, 2, 5, QUALITY_GOOD);
    assert_even(rig, 5);
    rig->plant->plant.tags[0].alarms.limits[LIMIT_H] = 35;
    /* now 40 exceeds its tag's new limit H of 35: the asset shows the reading beyond a limit, whatever the others are */
    assert_even(rig, 40);
    assert_as_fresh(rig);
    set(rig, 0, 40, QUALITY_BAD_NO_COMMUNICATION);
    assert_even(rig, 5);
    set(rig, 1, 75, QUALITY_BAD_NO_COMMUNICATION);
    set(rig, 2, 5, QUALITY_BAD_NO_COMMUNICATION);
    const struct scalars *scalars = show(rig);
    for (size_t j = 0; j < scalars->count; j++)
        assert_int_equal(scalars->at[j].no_data, 255);
}

TEST(test_beside_a_known_place_an_assumed_one_paints_nothing)
{
    struct field_rig *with = rig_create(synthetic_create(.vertices = 700, .sensors = 3)),
                     *without = rig_create(synthetic_create(.vertices = 700, .sensors = 3));
    with->plant->plant.tags[2].place.assumed = true;
    set(with, 2, 99, QUALITY_GOOD);
    without->plant->plant.tags[2].group = -1; /* in the plant for comparison, tag 2 is in no group, so its sensor does not count */
    const struct scalars *got = show(with), *want = show(without);
    assert_memory_equal(got->at, want->at, want->count * sizeof(*want->at));
    assert_false(field_is_assumed(with->field, 0, &with->params));
    set(with, 2, 99, QUALITY_BAD_NO_COMMUNICATION);
    got = show(with);
    assert_memory_equal(got->at, want->at, want->count * sizeof(*want->at));
}

TEST(test_over_range_passes_shepard_and_not_paper)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 700, .sensors = 3));
    set(rig, 0, 250, QUALITY_GOOD);
    set(rig, 1, -40, QUALITY_GOOD);
    const struct scalars *scalars = show(rig);
    assert_true(scalars->at[0].value == 250);
    assert_true(scalars->at[1].value == -40);
    rig->params.interpolation = INTERPOLATION_PAPER;
    scalars = show(rig);
    for (size_t j = 0; j < scalars->count; j++)
        assert_true(scalars->at[j].value >= 0 && scalars->at[j].value <= 100);
}

/* If all readings equal the range's maximum, the field must be exactly that, in spite of rounding, and not beyond the range. */
TEST(test_equal_readings_make_exactly_that)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 3000, .sensors = 11, .min = 0.1, .max = 0.3, .seed = sweep_seed()));
    rig->params.power = 3.3;
    for (size_t i = 0; i < 11; i++)
        set(rig, i, 0.3, QUALITY_GOOD);
    const struct scalars *scalars = show(rig);
    for (size_t j = 0; j < scalars->count; j++)
        assert_true(scalars->at[j].value == 0.3f);
    rig->params.interpolation = INTERPOLATION_PAPER;
    scalars = show(rig);
    for (size_t j = 0; j < scalars->count; j++)
        assert_true(scalars->at[j].value <= 0.3f && scalars->at[j].value >= 0.1f);
}

TEST(test_not_a_number_does_not_poison)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 700, .sensors = 4));
    const double poison[] = { (double)NAN, (double)INFINITY, -(double)INFINITY };
    for (int paper = 0; paper < 2; paper++)
        for (int k = 0; k < 3; k++) {
            rig->params.interpolation = paper ? INTERPOLATION_PAPER : INTERPOLATION_SHEPARD;
            set(rig, 1, poison[k], QUALITY_GOOD);
            assert_all_finite(show(rig));
            assert_int_equal(show(rig)->at[1].no_data, 255);
            set(rig, 1, 50, QUALITY_GOOD);
            assert_as_fresh(rig);
            assert_int_equal(show(rig)->at[1].no_data, 0);
        }
}

TEST(test_a_mad_reading_leaves_nothing_behind)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 700, .sensors = 9));
    const double mad[] = { 1e300, -1e300, 1e12, 3e7 };
    for (int k = 0; k < 4; k++) {
        set(rig, 4, 50, QUALITY_GOOD);
        show(rig);
        set(rig, 4, mad[k], QUALITY_GOOD);
        assert_all_finite(show(rig));
        set(rig, 4, 50, QUALITY_GOOD);
        assert_true_field(rig, 1e-5);
    }
}

TEST(test_half_the_weight_uncertain)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 300, .sensors = 2));
    for (int paper = 0; paper < 2; paper++) {
        rig->params.interpolation = paper ? INTERPOLATION_PAPER : INTERPOLATION_SHEPARD;
        for (size_t j = 0; j < 3; j++) { /* three vertices: nearer to the good sensor, half-way between both, nearer to the uncertain one */
            synthetic_set_distance(rig->plant, 0, 10 + j, 1 + (float)j);
            synthetic_set_distance(rig->plant, 1, 10 + j, 3 - (float)j);
        }
        set(rig, 0, 10, QUALITY_GOOD);
        set(rig, 1, 20, QUALITY_UNCERTAIN_LAST_USABLE);
        const struct scalars *scalars = show(rig);
        /* `uncertain` is a share, 0 to 255, so that the border of uncertainty can be drawn between vertices */
        assert_in_range(scalars->at[10].uncertain, 1, 127);
        assert_int_equal(scalars->at[11].uncertain, 128);
        assert_in_range(scalars->at[12].uncertain, 129, 254);
        assert_int_equal(scalars->at[11].no_data, 0);
        set(rig, 1, 20, QUALITY_GOOD);
        show(rig);
        assert_int_equal(scalars->at[12].uncertain, 0);
    }
}

TEST(test_a_part_that_nobody_reaches)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 900, .sensors = 4, .island = 50, .min = -5, .max = 5));
    for (int paper = 0; paper < 2; paper++) {
        rig->params.interpolation = paper ? INTERPOLATION_PAPER : INTERPOLATION_SHEPARD;
        rig->params.distance = DISTANCE_GEODESIC;
        const struct scalars *scalars = show(rig);
        for (size_t j = 0; j < scalars->count; j++)
            assert_int_equal(scalars->at[j].no_data, j < 850 ? 0 : 255);
        for (size_t j = 850; j < scalars->count; j++)
            assert_true(scalars->at[j].value == -5 && !scalars->at[j].uncertain);
        rig->params.distance = DISTANCE_EUCLIDEAN;
        scalars = show(rig);
        for (size_t j = 0; j < scalars->count; j++)
            assert_int_equal(scalars->at[j].no_data, 0);
    }
}

TEST(test_a_sensor_out_of_reach_does_not_make_its_place_lost)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 300, .sensors = 2));
    for (size_t j = 0; j < 300; j++)
        /* sensor 0 is Bad and, as if on another part, at an infinite distance from all vertices */
        synthetic_set_distance(rig->plant, 0, j, INFINITY);
    set(rig, 0, 90, QUALITY_BAD_SENSOR_FAILURE);
    set(rig, 1, 40, QUALITY_GOOD);
    const struct scalars *scalars = show(rig);
    for (size_t j = 0; j < scalars->count; j++)
        assert_true(scalars->at[j].no_data == 0 && scalars->at[j].value == 40);
}

TEST(test_reach_ends_the_field)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 300, .sensors = 2));
    rig->params.reach_m = 2;
    set(rig, 0, 30, QUALITY_GOOD);
    set(rig, 1, 70, QUALITY_GOOD);
    const float near_m[] = { 1.5f, 2.0f, 2.001f, 5 };
    for (size_t k = 0; k < 4; k++) {
        synthetic_set_distance(rig->plant, 0, 20 + k, near_m[k]);
        synthetic_set_distance(rig->plant, 1, 20 + k, 7);
    }
    const struct scalars *scalars = show(rig);
    for (size_t k = 0; k < 4; k++) {
        assert_int_equal(scalars->at[20 + k].no_data, k < 2 ? 0 : 255);
        /* beyond the reach a vertex has no data, but still a value, because drawing interpolates values between vertices
           across the border */
        assert_true(scalars->at[20 + k].value == 30);
    }
    /* the border of the data, at `lacking` = 127.5, lies half-way between these vertices, at the reach of 2 m */
    assert_int_equal(scalars->at[21].lacking, 127);
    assert_int_equal(scalars->at[22].lacking, 128);
    assert_true(scalars->at[20].lacking < 127 && scalars->at[23].lacking > 128);
}

/* A sensor's weight decreases to zero at its reach, so that the field has no visible edge there. */
TEST(test_a_sensor_fades_towards_its_reach)
{
    for (int paper = 0; paper < 2; paper++) {
        struct field_rig *rig = rig_create(synthetic_create(.vertices = 300, .sensors = 2));
        rig->params.interpolation = paper ? INTERPOLATION_PAPER : INTERPOLATION_SHEPARD;
        rig->params.decay = 0;
        rig->params.radius_m = 8;
        rig->params.reach_m = 4;
        set(rig, 0, 20, QUALITY_GOOD);
        set(rig, 1, 80, QUALITY_GOOD);
        /* vertices 20 to 219 are 2 m from sensor 0 and 2.5 m to 4.5 m from sensor 1, whose reach of 4 m ends at the 150th of
           them */
        for (size_t k = 0; k < 200; k++) {
            synthetic_set_distance(rig->plant, 0, 20 + k, 2);
            synthetic_set_distance(rig->plant, 1, 20 + k, 2.5f + 0.01f * (float)k);
        }
        synthetic_set_distance(rig->plant, 0, 20, 4);
        /* a vertex exactly at the reach of both sensors: its value is the mean of both readings */
        synthetic_set_distance(rig->plant, 1, 20, 4);
        /* a vertex just within reach of sensor 0 only: it shows that sensor's reading, unreduced */
        synthetic_set_distance(rig->plant, 0, 21, 3.999f);
        synthetic_set_distance(rig->plant, 1, 21, 4.001f);
        const struct scalar *at = show(rig)->at + 20;
        /* weight of sensor 1, relative to sensor 0, at 3 m, where half of its reach beyond the nearest sensor's distance is
           left */
        double weight = (paper ? exp(-1 / 8.0) : pow(2 / 3.0, 2)) * pow(0.5, 2);
        double part = weight / (1 + weight);
        assert_true(fabs((double)at[50].value - (20 + 60 * part)) < 1e-4);
        assert_true(fabs((double)at[0].value - 50) < 1e-4 && at[0].no_data == 0);
        assert_true(at[1].value == 20 && at[1].no_data == 0);
        for (int k = 2; k < 199; k++) {
            assert_true(at[k + 1].value <= at[k].value && at[k].value - at[k + 1].value < 0.4f);
            assert_true(k < 150 || at[k].value == 20);
        }
    }
}

TEST(test_a_sensor_of_strength_0_has_no_say)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 300, .sensors = 2));
    rig->plant->plant.tags[0].strength = 0;
    set(rig, 0, 90, QUALITY_BAD_SENSOR_FAILURE);
    set(rig, 1, 40, QUALITY_GOOD);
    const struct scalars *scalars = show(rig);
    for (size_t j = 0; j < scalars->count; j++)
        assert_true(scalars->at[j].no_data == 0 && scalars->at[j].value == 40);
    set(rig, 0, 90, QUALITY_GOOD);
    set(rig, 1, 40, QUALITY_BAD_SENSOR_FAILURE);
    for (size_t j = 0; j < scalars->count; j++)
        assert_int_equal(show(rig)->at[j].no_data, 255);
}

TEST(test_a_sensor_acts_on_its_own_asset_only)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 600, .sensors = 3, .assets = 2));
    struct scalar *before = test_memory(mem_array(600, sizeof(*before)));
    const struct scalars *other = field_scalars(rig->field, 1, &rig->params, rig->plant->snapshot);
    memcpy(before, other->at, 600 * sizeof(*before));
    uint64_t version = other->version;
    for (size_t i = 0; i < 3; i++)
        set(rig, i, 99, QUALITY_BAD_SENSOR_FAILURE);
    show(rig);
    other = field_scalars(rig->field, 1, &rig->params, rig->plant->snapshot);
    assert_int_equal(other->version, version);
    assert_memory_equal(other->at, before, 600 * sizeof(*before));
}

TEST(test_an_asset_without_sensors_of_the_group_has_no_field)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 300, .sensors = 2));
    rig->plant->plant.tags[0].group = rig->plant->plant.tags[1].group = 3;
    assert_null(field_scalars(rig->field, 0, &rig->params, rig->plant->snapshot));
}

/* --- incremental updates leave no errors in the sums ---------------------------------------------------------------------- */

TEST(test_an_hour_of_flicker_leaves_no_drift)
{
    uint64_t random = sweep_seed();
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 800, .sensors = 12, .seed = random));
    for (int paper = 0; paper < 2; paper++) {
        rig->params.interpolation = paper ? INTERPOLATION_PAPER : INTERPOLATION_SHEPARD;
        for (int tick = 0; tick < 36000; tick++) {
            set(rig, 4, 80.1, tick % 2 ? QUALITY_BAD_COMMUNICATION_ERROR : QUALITY_GOOD);
            set(rig, synthetic_random(&random) % 4, between(&random, 0, 100), QUALITY_GOOD);
            show(rig);
            if (tick % 4000 < 2)
                assert_as_fresh(rig);
        }
    }
}

/* As with loose wires, single sensors become Bad and good again at any moment while all readings change. Nothing of a sensor
   that is gone may remain in the sums. */
TEST(test_flicker_at_any_moment_leaves_no_drift)
{
    static const uint32_t qualities[] = { QUALITY_GOOD, QUALITY_BAD_COMMUNICATION_ERROR, QUALITY_UNCERTAIN_LAST_USABLE,
                                          QUALITY_BAD_SENSOR_FAILURE };
    uint64_t random = sweep_seed();
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 600, .sensors = 12, .seed = random));
    for (int paper = 0; paper < 2; paper++) {
        rig->params.interpolation = paper ? INTERPOLATION_PAPER : INTERPOLATION_SHEPARD;
        for (int tick = 0; tick < 36000; tick++) {
            if (synthetic_random(&random) % 8 == 0)
                set(rig, 4, between(&random, -1e4, 1e4), qualities[synthetic_random(&random) % 4]);
            for (int change = 0; change < 3; change++)
                set(rig, synthetic_random(&random) % 4, between(&random, 0, 100), QUALITY_GOOD);
            show(rig);
            if (synthetic_random(&random) % 100 == 0) {
                struct field *fresh = field_create(workers, &rig->plant->scene);
                const struct scalars *want = field_scalars(fresh, 0, &rig->params, rig->plant->snapshot), *got = show(rig);
                for (size_t j = 0; j < want->count; j++) {
                    const struct scalar *a = &want->at[j], *b = &got->at[j];
                    assert_true(a->lacking == b->lacking && a->uncertain == b->uncertain && a->no_data == b->no_data);
                    assert_true(fabsf(a->value - b->value) <= 1e-6f * 1e4f);
                }
                field_destroy(&fresh);
            }
        }
    }
}

static float worst_difference(const struct field_rig *rig)
{
    struct field *fresh = field_create(workers, &rig->plant->scene);
    const struct scalars *want = field_scalars(fresh, 0, &rig->params, rig->plant->snapshot), *got = show(rig);
    float worst = 0;
    for (size_t j = 0; j < want->count; j++)
        worst = fmaxf(worst, fabsf(want->at[j].value - got->at[j].value));
    field_destroy(&fresh);
    return worst;
}

TEST(test_an_hour_of_changes_leaves_no_drift)
{
    uint64_t random = sweep_seed();
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 600, .sensors = 40, .seed = random));
    for (int paper = 0; paper < 2; paper++) {
        rig->params.interpolation = paper ? INTERPOLATION_PAPER : INTERPOLATION_SHEPARD;
        for (int tick = 0; tick < 36000; tick++) {
            for (int change = 0; change < 5; change++)
                set(rig, synthetic_random(&random) % 40, between(&random, -100, 200), QUALITY_GOOD);
            show(rig);
            if (tick % 1000 == 999)
                assert_true(worst_difference(rig) <= 1e-6f * 100);
        }
    }
}

/* Changes of one reading that are large, but small enough to be added to the sums, leave rounding errors there. Later small
   changes are added, too, and keep these errors. After some thousand additions, the field computes the sums from all readings,
   and has the same bits as a new field again. */
TEST(test_sums_are_made_anew_now_and_then)
{
    uint64_t random = sweep_seed();
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 300, .sensors = 12, .seed = random));
    int tick = 0, most = 10000;
    for (size_t i = 0; i < 12; i++) /* readings near 0, so that even the smallest rounding error changes a float */
        set(rig, i, 0.01 * (double)i, QUALITY_GOOD);
    show(rig);
    for (int large = 0; large < 2000; large++) {
        set(rig, 5, between(&random, 1e7, 4e7), QUALITY_GOOD);
        show(rig);
    }
    set(rig, 5, 0.05, QUALITY_GOOD);
    assert_true(worst_difference(rig) > 0);
    for (; tick < most && worst_difference(rig) > 0; tick++)
        set(rig, 5, tick % 2 ? 0.05 : 0.06, QUALITY_GOOD);
    assert_in_range(tick, 1, most - 1);
    assert_as_fresh(rig);
}

TEST(test_a_day_of_changes_leaves_no_drift)
{
    uint64_t random = sweep_seed();
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 300, .sensors = 12, .seed = random));
    for (int tick = 0; tick < 86400; tick++) {
        set(rig, synthetic_random(&random) % 12, between(&random, -1000, 1000), QUALITY_GOOD);
        show(rig);
    }
    for (size_t i = 0; i < 12; i++)
        set(rig, i, 30 + (double)i, QUALITY_GOOD);
    set(rig, 0, 31, QUALITY_GOOD);
    assert_true_field(rig, 1e-5);
}

TEST(test_cut_of_the_work_does_not_matter)
{
    uint64_t random = sweep_seed();
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 70000, .sensors = 9, .seed = random));
    struct workers *one = test_workers(1), *many = test_workers(5);
    struct field *alone = field_create(one, &rig->plant->scene), *crowd = field_create(many, &rig->plant->scene);
    for (int tick = 0; tick < 12; tick++) {
        rig->params.interpolation = tick % 6 < 3 ? INTERPOLATION_PAPER : INTERPOLATION_SHEPARD;
        set(rig, synthetic_random(&random) % 9, between(&random, 0, 100), tick % 4 ? QUALITY_GOOD : QUALITY_BAD_SENSOR_FAILURE);
        const struct scalars *a = field_scalars(alone, 0, &rig->params, rig->plant->snapshot);
        const struct scalars *b = field_scalars(crowd, 0, &rig->params, rig->plant->snapshot);
        assert_memory_equal(a->at, b->at, a->count * sizeof(*a->at));
        assert_int_equal(a->version, b->version);
        assert_true(a->travel == b->travel);
    }
    field_destroy(&alone);
    field_destroy(&crowd);
}

/* --- versions ------------------------------------------------------------------------------------------------------------- */

TEST(test_version_grows_with_real_changes_only)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 700, .sensors = 3));
    const struct scalars *scalars = show(rig);
    uint64_t version = scalars->version, flags = scalars->flags_version;
    double travel = scalars->travel;
    assert_true(version > 0 && flags == version);
    rig->plant->snapshot->readings[1].age_ns = 7;
    show(rig);
    assert_int_equal(scalars->version, version);
    assert_int_equal(scalars->oldest_age_ns, 7);
    float before = scalars->at[1].value;
    set(rig, 1, (double)before + 2.5, QUALITY_GOOD);
    show(rig);
    assert_true(scalars->version > version);
    assert_int_equal(scalars->flags_version, flags);
    /* `travel` grows by the change of 2.5 that the sensor's own vertex shows, the largest one */
    assert_true(fabs(scalars->travel - travel - 2.5) < 1e-3);
    version = scalars->version;
    set(rig, 1, (double)before + 2.5, QUALITY_UNCERTAIN_UNITS_EXCEEDED);
    show(rig);
    assert_true(scalars->version > version && scalars->flags_version == scalars->version);
    version = scalars->version;
    rig->params.interpolation = INTERPOLATION_PAPER;
    set(rig, 1, 300, QUALITY_GOOD);
    uint64_t paper = show(rig)->version;
    /* the scalars of other parameters have a higher version, too, because all scalars take theirs from one counter */
    assert_true(paper > version);
    set(rig, 1, 400, QUALITY_GOOD);
    assert_int_equal(show(rig)->version, paper); /* both are clamped to MAX */
}

TEST(test_a_bad_reading_that_moves_changes_nothing)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 700, .sensors = 3));
    set(rig, 1, 10, QUALITY_BAD_SENSOR_FAILURE);
    uint64_t version = show(rig)->version;
    set(rig, 1, 90, QUALITY_BAD_DEVICE_FAILURE);
    assert_int_equal(show(rig)->version, version);
}

TEST(test_a_reading_without_weight_changes_nothing)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 700, .sensors = 3));
    rig->plant->plant.tags[1].strength = 0;
    uint64_t version = show(rig)->version;
    set(rig, 1, 77, QUALITY_GOOD);
    assert_int_equal(show(rig)->version, version);
}

/* --- sharing between sessions and the memory limit ------------------------------------------------------------------------ */

TEST(test_equal_parameters_share)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 700, .sensors = 3));
    struct field_params again;
    field_params_default(&rig->plant->plant, 0, &again);
    const struct scalars *first = show(rig);
    size_t bytes = field_bytes(rig->field);
    assert_ptr_equal(field_scalars(rig->field, 0, &again, rig->plant->snapshot), first);
    assert_int_equal(field_bytes(rig->field), bytes);
    again.power = 3;
    assert_ptr_not_equal(field_scalars(rig->field, 0, &again, rig->plant->snapshot), first);
    assert_true(field_bytes(rig->field) > bytes);
}

TEST(test_instances_share_their_weights)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 700, .sensors = 16, .assets = 10));
    size_t bytes[3] = { 0 };
    for (int round = 0; round < 3; round++) {
        for (int asset = 0; asset < 10; asset++) {
            set(rig, (size_t)asset * 16, 5 + round, QUALITY_GOOD);
            field_scalars(rig->field, asset, &rig->params, rig->plant->snapshot);
            bytes[0] = asset == 0 && round == 0 ? field_bytes(rig->field) : bytes[0];
        }
        bytes[1 + (round > 0)] = field_bytes(rig->field);
    }
    size_t columns = (size_t)3 * 256 * 16 * sizeof(float), state_bytes = (bytes[2] - columns - bytes[0]) / 9;
    /* when a column (a sensor's weights at all vertices) has been used twice, it is cached, once for all ten instances of the
       asset file */
    assert_int_equal(bytes[1], bytes[2]);
    assert_true(state_bytes < bytes[0] && state_bytes >= 700 * 16);
    for (int asset = 0; asset < 10; asset++)
        assert_true(field_scalars(rig->field, asset, &rig->params, rig->plant->snapshot)->at[0].value == 7);
}

static size_t bytes_allocated(void)
{
    struct mallinfo2 info = mallinfo2();
    return info.uordblks + info.hblkhd;
}

TEST(test_dragging_stays_under_the_bound)
{
    const size_t slack = 256 << 10; /* allowance in bytes for tables and for temporary memory during a call */
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 5000, .sensors = 20, .assets = 2));
    size_t bound = 3 << 20;
    field_set_cache_limit(rig->field, bound);
    rig->params.interpolation = INTERPOLATION_PAPER;
    size_t before = bytes_allocated();
    for (int step = 0; step < 60; step++)
        for (int session = 0; session < 50; session++) {
            rig->params.decay = 0.5 + 0.001 * step + 0.02 * session;
            for (int asset = 0; asset < 2; asset++)
                assert_non_null(field_scalars(rig->field, asset, &rig->params, rig->plant->snapshot));
            assert_true(field_bytes(rig->field) <= bound);
            assert_true(bytes_allocated() <= before + bound + slack);
            if (step % 20 == 19 && session % 10 == 0)
                assert_as_fresh(rig);
        }
}

/* A sensor's weights at all vertices (a column) may be evicted, never cached, or cached for only some vertices: the field has
   the same bits as with all columns cached. */
TEST(test_without_room_for_columns_the_bits_are_the_same)
{
    uint64_t random = sweep_seed();
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 3000, .sensors = 37, .seed = random));
    struct field *tight = field_create(workers, &rig->plant->scene), *half = field_create(workers, &rig->plant->scene);
    const size_t columns = (size_t)3000 * 37 * sizeof(float);
    field_set_cache_limit(tight, 1);
    for (int tick = 0; tick < 60; tick++) {
        /* limit of the cache in bytes: in most rounds enough for half of all columns (weights of a sensor at all vertices) and
           the 450,000 bytes that the rest takes, in the others for everything */
        size_t bound = tick % 20 < 15 ? columns / 2 + 500000 : 4 * columns;
        field_set_cache_limit(half, bound);
        rig->params.interpolation = tick / 20 == 1 ? INTERPOLATION_PAPER : INTERPOLATION_SHEPARD;
        rig->params.power = tick / 20 == 2 ? 3.1 : 2;
        set(rig, synthetic_random(&random) % 37, between(&random, 0, 100), QUALITY_GOOD);
        if (tick % 7 == 0)
            set(rig, 11, 50, QUALITY_UNCERTAIN_LAST_USABLE + (synthetic_random(&random) % 2 ? 0x40000000u : 0));
        const struct scalars *want = show(rig), *got = field_scalars(tight, 0, &rig->params, rig->plant->snapshot);
        assert_memory_equal(got->at, want->at, want->count * sizeof(*want->at));
        got = field_scalars(half, 0, &rig->params, rig->plant->snapshot);
        assert_memory_equal(got->at, want->at, want->count * sizeof(*want->at));
        assert_true(field_bytes(half) <= bound);
    }
    assert_true(field_bytes(tight) < columns);
    assert_true(field_bytes(half) > columns && field_bytes(rig->field) > columns);
    field_destroy(&tight);
    field_destroy(&half);
}

/* If the limit is too small for all columns (cached weights of the sensors), the cache uses all of it; once it is large enough,
   all columns are cached. */
TEST(test_as_many_columns_as_fit_are_kept)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 3000, .sensors = 37));
    const size_t block = (size_t)37 * (256 * sizeof(float) + 1), columns = (3000 + 255) / 256 * block;
    set(rig, 0, 1, QUALITY_GOOD);
    show(rig);
    size_t bare = field_bytes(rig->field), rooms[] = { block - 1, 4 * block + 100, 2 * columns };
    size_t want[] = { 0, 4 * block, columns };
    for (int room = 0; room < 3; room++) {
        field_set_cache_limit(rig->field, bare + rooms[room]);
        for (int round = 0; round < 3; round++) {
            set(rig, 0, room + round * 0.1, QUALITY_GOOD);
            show(rig);
        }
        assert_int_equal(field_bytes(rig->field), bare + want[room]);
    }
}

/* Two sessions with different parameters request all assets in turn, although the cache has less room than one asset needs:
   pointers returned to one session must stay valid until it has got all assets. */
TEST(test_scalars_of_the_same_parameters_stay)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 2000, .sensors = 5, .assets = 8));
    field_set_cache_limit(rig->field, 100000);
    for (int round = 0; round < 6; round++) {
        const struct scalars *all[8];
        rig->params.power = 2 + round % 2;
        for (int asset = 0; asset < 8; asset++)
            all[asset] = field_scalars(rig->field, asset, &rig->params, rig->plant->snapshot);
        for (int asset = 0; asset < 8; asset++) {
            assert_int_equal(all[asset]->asset, asset);
            assert_true(all[asset]->at[0].value == (float)rig->plant->snapshot->readings[asset * 5].value);
        }
    }
}

/* With few sensors and cached weights, one pass computes all sums (the fast path). It must give the same bits and report the
   same changes as the general path. */
TEST(test_few_sensors_are_summed_in_one_go)
{
    enum { VERTICES = 1100 };
    uint64_t random = sweep_seed();
    for (size_t sensors = 1; sensors <= 9; sensors++)
        for (int paper = 0; paper < 2; paper++) {
            struct field_rig *rig = rig_create(synthetic_create(.vertices = VERTICES, .sensors = sensors, .seed = random + sensors));
            float before[VERTICES] = { 0 };
            double travel = 0;
            rig->params.interpolation = paper ? INTERPOLATION_PAPER : INTERPOLATION_SHEPARD;
            for (int round = 0; round < 6; round++) {
                for (size_t i = 0; i < sensors; i++)
                    set(rig, i, between(&random, -20, 120), QUALITY_GOOD);
                const struct scalars *now = show(rig);
                double most = 0;
                for (size_t v = 0; v < VERTICES; v++) {
                    most = fmax(most, (double)fabsf(now->at[v].value - before[v]));
                    before[v] = now->at[v].value;
                }
                /* `travel` must grow by the largest change of any vertex, also with mode paper, which clamps a value twice if
                   only one sensor reaches the vertex */
                assert_true(fabs(now->travel - travel - most) < 1e-9);
                travel = now->travel;
                uint64_t version = now->version;
                assert_true(show(rig)->version == version);
                assert_as_fresh(rig);
            }
        }
}

/* Asserts that the first `count` vertices equal those of a newly created field. */
static void assert_first_as_fresh(const struct field_rig *rig, size_t count)
{
    struct field *fresh = field_create(workers, &rig->plant->scene);
    const struct scalars *want = field_scalars(fresh, 0, &rig->params, rig->plant->snapshot);
    const struct scalars *got = field_scalars_of(rig->field, 0, &rig->params, rig->plant->snapshot, count);
    assert_true(got->ready >= count);
    assert_memory_equal(got->at, want->at, got->ready * sizeof(*want->at));
    field_destroy(&fresh);
}

/* Computing assets in parallel equals computing them one by one, whatever changed, while weights are being cached and
   afterwards, and with any cache size. */
static void check_many_at_once(size_t sensors)
{
    enum { ASSETS = 12, VERTICES = 1500 };
    struct field_rig *rig = rig_create(synthetic_create(.vertices = VERTICES, .sensors = sensors, .assets = ASSETS));
    struct field *alone = field_create(workers, &rig->plant->scene);
    uint64_t random = sweep_seed();
    size_t bounds[] = { FIELD_DEFAULT_BYTES, 100000 };
    for (int round = 0; round < 60; round++) {
        int assets[ASSETS];
        size_t counts[ASSETS], asset_count = 0;
        rig->params.interpolation = round / 10 % 2 ? INTERPOLATION_PAPER : INTERPOLATION_SHEPARD;
        field_set_cache_limit(rig->field, bounds[round / 30]);
        for (size_t i = 0; i < ASSETS * sensors; i++)
            if (synthetic_random(&random) % 3 == 0)
                set(rig, i, (double)(synthetic_random(&random) % 1000) / 10,
                    synthetic_random(&random) % 16 == 0 ? QUALITY_UNCERTAIN : QUALITY_GOOD);
        for (int asset = 0; asset < ASSETS; asset++)
            if (synthetic_random(&random) % 4) {
                assets[asset_count] = asset;
                counts[asset_count++] = synthetic_random(&random) % 4 ? VERTICES : VERTICES / 3;
            }
        field_update_all(rig->field, assets, counts, asset_count, &rig->params, rig->plant->snapshot);
        for (size_t i = 0; i < asset_count; i++) {
            const struct scalars *want = field_scalars_of(alone, assets[i], &rig->params, rig->plant->snapshot, counts[i]);
            const struct scalars *got = field_scalars_of(rig->field, assets[i], &rig->params, rig->plant->snapshot, counts[i]);
            assert_int_equal(got->asset, assets[i]);
            for (size_t v = 0; v < counts[i]; v++) { /* values may differ by rounding, because some sums were dropped and computed again */
                assert_true(fabsf(got->at[v].value - want->at[v].value) < 1e-4f);
                assert_true(got->at[v].no_data == want->at[v].no_data && got->at[v].uncertain == want->at[v].uncertain &&
                            got->at[v].lacking == want->at[v].lacking && got->at[v].no_limits == want->at[v].no_limits);
            }
        }
    }
    field_destroy(&alone);
}

TEST(test_many_at_once_are_as_one_by_one)
{
    check_many_at_once(5); /* 5 sensors: so few that sums are not kept but computed each time; 12: sums are kept */
    check_many_at_once(12);
}

/* Far assets, of which only the first vertices are drawn: the cache, too small for all weights, must keep the weights of these
   vertices. */
static void check_far_assets(size_t sensors)
{
    enum { ASSETS = 40, VERTICES = 20000, DRAWN = 300 };
    struct field_rig *rig = rig_create(synthetic_create(.vertices = VERTICES, .sensors = sensors, .assets = ASSETS));
    int assets[ASSETS];
    size_t counts[ASSETS], columns = (size_t)(VERTICES + 255) / 256 * sensors * (256 * sizeof(float) + 1), last = 0, bound = 4 << 20;
    field_set_cache_limit(rig->field, columns + bound);
    for (int round = 0; round < 4; round++) {
        for (int i = 0; i < ASSETS; i++) {
            assets[i] = i;
            counts[i] = DRAWN;
            set(rig, (size_t)i * sensors, i + round, QUALITY_GOOD);
        }
        field_update_all(rig->field, assets, counts, ASSETS, &rig->params, rig->plant->snapshot);
        for (int i = 0; i < ASSETS; i++)
            assert_true(field_scalars_of(rig->field, i, &rig->params, rig->plant->snapshot, DRAWN)->at[0].value == (float)(i + round));
        assert_true(round == 0 || field_bytes(rig->field) > columns);
        assert_true(round < 2 || field_bytes(rig->field) == last);
        last = field_bytes(rig->field);
    }
    size_t each = sizeof(struct scalar) + (sensors > 8 ? sizeof(double) : 0); /* bytes of a vertex */
    for (size_t count = DRAWN, had = 512; count < VERTICES; count *= 4) {
        size_t room = (count + 255) / 256 * 256;
        field_scalars_of(rig->field, 0, &rig->params, rig->plant->snapshot, count);
        assert_int_equal(field_bytes(rig->field), last + (room - had) * each);
        assert_first_as_fresh(rig, count);
        last = field_bytes(rig->field);
        had = room;
    }
    assert_true(last <= columns + bound);
    assert_as_fresh(rig);
}

TEST(test_far_assets_have_room_for_what_is_drawn)
{
    check_far_assets(5);
    check_far_assets(12);
}

/* --- levels, pieces ------------------------------------------------------------------------------------------------------- */

TEST(test_a_level_is_a_prefix)
{
    uint64_t random = sweep_seed();
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 3000, .sensors = 20, .seed = random));
    const size_t counts[] = { 300, 3000, 300, 300, 1, 2000, 700, 2999 };
    for (int paper = 0; paper < 2; paper++) {
        rig->params.interpolation = paper ? INTERPOLATION_PAPER : INTERPOLATION_SHEPARD;
        for (int round = 0; round < 200; round++) {
            for (size_t i = 0; round % 3 == 0 && i < 20; i++) /* all sensors: sums are recomputed */
                set(rig, i, between(&random, 0, 100), synthetic_random(&random) % 9 ? QUALITY_GOOD : QUALITY_BAD_SENSOR_FAILURE);
            assert_first_as_fresh(rig, counts[(size_t)round % 8]);
        }
    }
}

TEST(test_a_prefix_costs_less)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 20000, .sensors = 4));
    const struct scalars *scalars = field_scalars_of(rig->field, 0, &rig->params, rig->plant->snapshot, 500);
    assert_int_equal(scalars->ready, 512);
    uint64_t version = scalars->version, grown = scalars->grown;
    field_scalars_of(rig->field, 0, &rig->params, rig->plant->snapshot, 512);
    assert_int_equal(scalars->version, version);
    show(rig); /* a client sees the asset from near and needs all vertices */
    assert_true(scalars->ready == 20000 && scalars->version > version && scalars->grown > grown && scalars->flags_version > version);
    /* then only the first 500 are requested: after a while, the others are no longer kept up to date */
    for (int tick = 0; tick < 3; tick++) {
        set(rig, 2, 10 + tick, QUALITY_GOOD);
        field_scalars_of(rig->field, 0, &rig->params, rig->plant->snapshot, 500);
    }
    assert_int_equal(scalars->ready, 512);
    assert_true(show(rig)->at[2].value == 12 && scalars->ready == 20000);
}

/* A field of straight-line distances to few sensors is evaluated per pixel. Neither a picture nor a pick may then compute the
   values at vertices. */
TEST(test_a_pick_of_an_exact_field_computes_no_vertex)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 3000, .sensors = 20));
    const struct field_place place = { .corners = { 5, 6, 7 }, .parts = { 1, 0, 0 } };
    rig->params.distance = DISTANCE_EUCLIDEAN;
    for (int paper = 0; paper < 2; paper++) {
        rig->params.interpolation = paper ? INTERPOLATION_PAPER : INTERPOLATION_SHEPARD;
        struct field *whole = field_create(workers, &rig->plant->scene);
        for (int round = 0; round < 3; round++) {
            struct field_point point;
            set(rig, 2, 10 + round, round == 2 ? QUALITY_BAD_SENSOR_FAILURE : QUALITY_GOOD);
            assert_true(field_at(rig->field, 0, &rig->params, rig->plant->snapshot, &place, &point));
            const struct scalars *drawn = field_scalars_of(rig->field, 0, &rig->params, rig->plant->snapshot, 0);
            assert_int_equal(drawn->ready, 0);
            const struct scalar *want = &field_scalars(whole, 0, &rig->params, rig->plant->snapshot)->at[5];
            assert_true(fabs(point.value - (double)want->value) < 1e-3 && point.no_data == (want->no_data > 0));
            assert_true(point.uncertain == (want->uncertain > 127));
        }
        field_destroy(&whole);
    }
}

TEST(test_in_pieces_it_is_the_same)
{
    uint64_t random = sweep_seed();
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 5000, .sensors = 30, .seed = random));
    for (int round = 0; round < 6; round++) {
        double first = between(&random, 0, 100);
        int pieces = 1;
        rig->params.power = 1 + 0.5 * round;
        set(rig, 3, first, QUALITY_GOOD);
        set(rig, 8, 5, round % 2 ? QUALITY_GOOD : QUALITY_BAD_SENSOR_FAILURE);
        while (!field_advance(rig->field, 0, &rig->params, rig->plant->snapshot, 5000, 10000)) {
            if (pieces++ == 2)
                /* a reading that changes after the computation has begun must not show in it, but in the next one */
                set(rig, 3, first + 1, QUALITY_GOOD);
        }
        assert_in_range(pieces, 3, 100);
        assert_true(show(rig)->at[3].value == (float)(first + 1));
        set(rig, 8, 5, round % 2 ? QUALITY_BAD_SENSOR_FAILURE : QUALITY_GOOD);
        assert_as_fresh(rig);
    }
}

TEST(test_what_is_under_way_may_be_dropped)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 5000, .sensors = 30));
    struct field_params other = rig->params;
    field_set_cache_limit(rig->field, 0);
    for (int round = 0; round < 20; round++) {
        rig->params.power = 1 + 0.1 * round;
        other.power = 4 + 0.1 * round;
        field_advance(rig->field, 0, &rig->params, rig->plant->snapshot, 5000, 10000);
        field_advance(rig->field, 0, &other, rig->plant->snapshot, 5000, 10000);
    }
    assert_as_fresh(rig);
    /* destroying a field must release a computation that was not finished */
    field_advance(rig->field, 0, &other, rig->plant->snapshot, 5000, 10000);
}

/* --- parameters, probe, distance ------------------------------------------------------------------------------------------ */

TEST(test_parameters_out_of_range)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 300, .sensors = 1));
    const struct plant *plant = &rig->plant->plant;
    assert_null(field_params_wrong(plant, &rig->params));
#define WRONG(field_name, bad, word)                                                                                                       \
    do {                                                                                                                                   \
        struct field_params p = rig->params;                                                                                               \
        p.field_name = bad;                                                                                                                \
        const char *why = field_params_wrong(plant, &p);                                                                                   \
        assert_non_null(why);                                                                                                              \
        assert_int_equal(strncmp(why, word, strlen(word)), 0);                                                                             \
        assert_false(field_params_equal(&p, &rig->params));                                                                                \
    } while (0)
    WRONG(group, 1, "group");
    WRONG(group, -1, "group");
    WRONG(strength, -0.1, "strength");
    WRONG(strength, (double)NAN, "strength");
    WRONG(decay, 100.5, "decay");
    WRONG(power, 0.4, "power");
    WRONG(power, 17, "power");
    WRONG(power, (double)INFINITY, "power");
    WRONG(radius_m, -1, "radius_m");
    WRONG(radius_m, 2e6, "radius_m");
    WRONG(radius_m, (double)NAN, "radius_m");
    WRONG(reach_m, 0, "reach_m");
    WRONG(reach_m, (double)NAN, "reach_m");
    WRONG(show, SHOW_DISTANCE, "sensor");
    WRONG(show, SHOW_DIFFERENCE, "baseline");
    WRONG(show, (enum field_show)7, "show");
    WRONG(sensor, 1, "sensor");
    WRONG(override_count = 1; p.overrides[0].tag, 1, "sensors");
    WRONG(override_count = 1; p.overrides[0].strength, 101, "sensors");
    WRONG(override_count = 1; p.overrides[0].decay, NAN, "sensors");
#undef WRONG
    rig->params.radius_m = 12;
    rig->params.reach_m = (double)INFINITY;
    assert_null(field_params_wrong(plant, &rig->params));
}

TEST(test_distance_from_one_sensor)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 500, .sensors = 3, .assets = 2, .island = 20));
    struct field_params straight = rig->params;
    double low, high;
    rig->params.show = straight.show = SHOW_DISTANCE;
    rig->params.sensor = straight.sensor = 4;
    straight.distance = DISTANCE_EUCLIDEAN;
    /* distances from sensor 4 are refused for asset 0: the sensor is on asset 1, and no path along surfaces leads there */
    assert_null(field_scalars(rig->field, 0, &rig->params, rig->plant->snapshot));
    const struct scalars *way = field_scalars(rig->field, 1, &rig->params, rig->plant->snapshot);
    const struct scalars *line = field_scalars(rig->field, 1, &straight, rig->plant->snapshot);
    float most = 0;
    assert_int_equal(way->asset, 1);
    assert_int_equal(way->count, 500);
    assert_true(way->version && line->version > way->version && way->oldest_age_ns == INT64_MAX);
    for (size_t j = 0; j < 480; j++) {
        float want = asset_distance_m(&rig->plant->file.view, 1, j);
        assert_true(way->at[j].value == want && !way->at[j].no_data);
        assert_true(line->at[j].value <= way->at[j].value + 1e-5f);
        most = fmaxf(most, want);
    }
    assert_true(way->at[1].value == 0 && line->at[1].value == 0);
    for (size_t j = 480; j < 500; j++)
        assert_true(way->at[j].no_data == 255 && way->at[j].value == most && line->at[j].no_data == 0);
    field_default_range(&rig->plant->scene, &rig->params, &low, &high);
    assert_true(low == 0 && high >= (double)most * (1 - 1e-6) && high < 1.06 * (double)most);
    uint64_t version = way->version;
    set(rig, 4, 7, QUALITY_BAD_SENSOR_FAILURE); /* the displayed distances must not change: sensor 4 is Bad now, but is still there */
    assert_int_equal(field_scalars(rig->field, 1, &rig->params, rig->plant->snapshot)->version, version);
}

/* --- difference, overrides ------------------------------------------------------------------------------------------------ */

/* Returns the scalars of a separate field with these parameters, to compare with the shared one. */
static struct scalar *shown_alone(const struct field_rig *rig, const struct field_params *params, const struct snapshot *snapshot)
{
    struct field *alone = field_create(workers, &rig->plant->scene);
    const struct scalars *scalars = field_scalars(alone, 0, params, snapshot);
    struct scalar *copy = mem_array(scalars->count, sizeof(*copy));
    memcpy(copy, scalars->at, scalars->count * sizeof(*copy));
    field_destroy(&alone);
    return copy;
}

static void assert_difference(const struct field_rig *rig, const struct snapshot *then)
{
    struct field_params values = rig->params;
    values.show = SHOW_VALUE;
    struct scalar *before = shown_alone(rig, &values, then), *after = shown_alone(rig, &values, rig->plant->snapshot);
    const struct scalars *scalars = show(rig);
    for (size_t j = 0; j < scalars->count; j++) {
        float want = after[j].value - before[j].value;
        if (fabsf(scalars->at[j].value - want) > 1e-3f || scalars->at[j].no_data != (before[j].no_data | after[j].no_data))
            fail_msg("vertex %zu: %g, not %g", j, (double)scalars->at[j].value, (double)want);
    }
    mem_free(before);
    mem_free(after);
}

TEST(test_difference_is_that_of_two_fields)
{
    uint64_t random = sweep_seed();
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 900, .sensors = 12, .island = 9, .seed = random));
    struct baselines *baselines = baselines_create();
    field_set_baselines(rig->field, baselines);
    rig->params.show = SHOW_DIFFERENCE;
    for (int paper = 0; paper < 2; paper++) {
        rig->params.interpolation = paper ? INTERPOLATION_PAPER : INTERPOLATION_SHEPARD;
        for (size_t i = 0; i < 12; i++)
            /* some readings lie beyond the range: mode paper clamps both values before it subtracts them */
            set(rig, i, between(&random, -30, 130), QUALITY_GOOD);
        rig->params.baseline = baselines_set(baselines, "then", rig->plant->snapshot);
        assert_int_equal(show(rig)->at[500].value, 0);
        const struct snapshot *then = baselines_take(baselines, rig->params.baseline);
        for (int change = 0; change < 20; change++) {
            set(rig, synthetic_random(&random) % 12, between(&random, -30, 130), QUALITY_GOOD);
            assert_difference(rig, then);
        }
        baselines_give(baselines, &then);
        assert_int_equal(show(rig)->at[500].no_data, 0);
    }
    baselines_destroy(&baselines);
}

TEST(test_difference_needs_both)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 400, .sensors = 4));
    struct baselines *baselines = baselines_create();
    rig->params.show = SHOW_DIFFERENCE;
    rig->params.baseline = 1;
    assert_int_equal(show(rig)->at[2].no_data, 255); /* the field has no baselines */
    field_set_baselines(rig->field, baselines);
    set(rig, 1, 50, QUALITY_BAD_SENSOR_FAILURE);
    set(rig, 2, 50, QUALITY_UNCERTAIN_LAST_USABLE);
    rig->params.baseline = baselines_set(baselines, "then", rig->plant->snapshot);
    set(rig, 1, 90, QUALITY_GOOD);
    set(rig, 2, 60, QUALITY_GOOD);
    set(rig, 3, 60, QUALITY_BAD_SENSOR_FAILURE);
    const struct scalars *scalars = show(rig);
    /* no data at sensors 1 and 3, since one of the two readings is missing: sensor 1 was Bad in the baseline, and sensor 3 is
       Bad now */
    assert_true(scalars->at[1].no_data && scalars->at[3].no_data);
    assert_true(!scalars->at[2].no_data && scalars->at[2].uncertain > 127); /* sensor 2 was Uncertain then */
    /* sensor 0 has the same value in both, so the difference is 0, although other sensors have changed from Bad to Good */
    assert_true(!scalars->at[0].no_data && scalars->at[0].value == 0);
    /* a baseline has a name and is shared: setting it again replaces it for all sessions, also for this one */
    baselines_set(baselines, "then", rig->plant->snapshot);
    scalars = show(rig);
    assert_true(!scalars->at[1].no_data && scalars->at[1].value == 0 && scalars->at[3].no_data);
    baselines_remove(baselines, "then");
    scalars = show(rig);
    for (size_t j = 0; j < scalars->count; j++)
        assert_int_equal(scalars->at[j].no_data, 255);
    assert_as_fresh(rig);
    baselines_destroy(&baselines);
}

TEST(test_overrides_are_as_if_configured)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 700, .sensors = 6, .seed = sweep_seed()));
    for (int paper = 0; paper < 2; paper++) {
        rig->params.interpolation = paper ? INTERPOLATION_PAPER : INTERPOLATION_SHEPARD;
        struct field_params overridden = rig->params;
        assert_true(field_params_override(&overridden, (struct field_override){ 4, 2.5f, FIELD_AS_CONFIGURED }));
        assert_true(field_params_override(&overridden, (struct field_override){ 1, 0.25f, 3 }));
        assert_false(field_params_equal(&overridden, &rig->params));
        struct scalar *plain = shown_alone(rig, &rig->params, rig->plant->snapshot);
        struct scalar *got = shown_alone(rig, &overridden, rig->plant->snapshot);
        rig->plant->plant.tags[4].strength = 2.5;
        rig->plant->plant.tags[1].strength = 0.25;
        rig->plant->plant.tags[1].decay = 3;
        struct scalar *want = shown_alone(rig, &rig->params, rig->plant->snapshot);
        assert_memory_equal(got, want, 700 * sizeof(*want));
        assert_memory_not_equal(got, plain, 700 * sizeof(*plain));
        rig->plant->plant.tags[4].strength = rig->plant->plant.tags[1].strength = rig->plant->plant.tags[1].decay = 1;
        mem_free(plain);
        mem_free(got);
        mem_free(want);
    }
}

TEST(test_overrides_are_bounded_and_ordered)
{
    struct field_rig *rig = rig_create(synthetic_create(.vertices = 300, .sensors = 300));
    struct field_params turned = rig->params, before = rig->params;
    for (int i = 0; i < FIELD_OVERRIDES; i++) {
        assert_true(field_params_override(&rig->params, (struct field_override){ i, (float)i / 10, FIELD_AS_CONFIGURED }));
        assert_true(field_params_override(&turned, (struct field_override){ FIELD_OVERRIDES - 1 - i, (float)(FIELD_OVERRIDES - 1 - i) / 10,
                                                                            FIELD_AS_CONFIGURED }));
    }
    /* the overrides of single sensors were added in another order, but the parameters are equal */
    assert_true(field_params_equal(&rig->params, &turned));
    assert_null(field_params_wrong(&rig->plant->plant, &rig->params));
    assert_false(field_params_override(&rig->params, (struct field_override){ FIELD_OVERRIDES, 1, 1 }));
    assert_true(field_params_override(&rig->params, (struct field_override){ 7, 1, 1 }));
    assert_true(field_params_override_of(&rig->params, 7)->decay == 1);
    for (int i = 0; i < FIELD_OVERRIDES; i++)
        assert_true(field_params_override(&rig->params, (struct field_override){ i, FIELD_AS_CONFIGURED, FIELD_AS_CONFIGURED }));
    assert_true(field_params_equal(&rig->params, &before));
}

static int set_up(void **state)
{
    (void)state;
    workers = workers_create(3);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    workers_destroy(&workers);
    return 0;
}

TEST_GROUP(set_up, tear_down)
