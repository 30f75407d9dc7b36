/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sensor coverage (how far the points of an asset are from sensors) of plates, compared with values computed by hand and with
   plain sums over dense samples. */
#include "placing/sensor_coverage.h"

#include "tests/support/test.h"

#include "base/math/vec.h"
#include "base/mem.h"
#include "message/place_message.h"
#include "tests/support/sweep.h"
#include "tests/support/toy.h"

enum { CELLS = 40, SENSORS = 3, SAMPLES = 800 };
static const double side_m = 4, sensors[SENSORS][3] = { { 0, 0, 0 }, { 4, 0, 0 }, { 4, 1.1, 0 } };

static int set_up(void **state)
{
    struct toy *toy = toy_create();
    struct test_shape shape = { 0 };
    shape_plate(&shape, TOY_STEEL, (double[3]){ 0, 0, 0 }, (double[3]){ side_m, 0, 0 }, (double[3]){ 0, side_m, 0 }, CELLS);
    toy_add(toy, "PLATE", &shape, (double[3]){ 100, 0, 7 }, sensors, SENSORS);
    shape_plate(&shape, TOY_STEEL, (double[3]){ 0, 0, 0 }, (double[3]){ 1, 0, 0 }, (double[3]){ 0, 1, 0 }, 2);
    toy_add(toy, "BARE", &shape, (double[3]){ 200, 0, 0 }, NULL, 0);
    *state = toy;
    return 0;
}

static int tear_down(void **state)
{
    struct toy *toy = *state;
    toy_destroy(&toy);
    return 0;
}

static struct sensor_coverage find(const struct toy *toy, double reach_m, double far_m, const uint8_t good[SENSORS])
{
    struct sensor_coverage gaps;
    assert_true(sensor_coverage_find(
        &(struct sensor_coverage_query){
            .scene = &toy->scene, .mode = DISTANCE_EUCLIDEAN, .reach_m = reach_m, .far_m = far_m, .good = good },
        &gaps));
    return gaps;
}

/* Returns the share of the plate's area where f(nearest sensor, limit_m) holds, from dense samples. */
static double share_of(bool (*f)(const double nearest[2], double limit_m), double limit_m)
{
    double hit = 0;
    for (int i = 0; i < SAMPLES; i++)
        for (int j = 0; j < SAMPLES; j++) {
            double x = side_m * (i + 0.5) / SAMPLES, y = side_m * (j + 0.5) / SAMPLES, nearest[2] = { INFINITY, 0 };
            for (int s = 0; s < SENSORS; s++) {
                double m = hypot(x - sensors[s][0], y - sensors[s][1]);
                /* nearest[]: distance and number of the nearest sensor; of two equally near ones the later counts, because the
                   last one is the good one */
                if (m <= nearest[0]) {
                    nearest[0] = m;
                    nearest[1] = s;
                }
            }
            hit += f(nearest, limit_m);
        }
    return hit / SAMPLES / SAMPLES;
}

static bool is_far(const double nearest[2], double limit_m)
{
    return nearest[0] > limit_m;
}

static bool is_lost(const double nearest[2], double limit_m)
{
    return nearest[0] > limit_m || nearest[1] == 0;
}

TEST_WITH(test_the_farthest_place_and_the_next_sensor, set_up, tear_down)
{
    struct sensor_coverage gaps = find(*state, INFINITY, 0, (uint8_t[SENSORS]){ 1, 1, 1 });
    assert_int_equal(gaps.sensors, SENSORS);
    /* the farthest point of the plate is at the edge y = 4, equally far from the first and the third sensor: x^2 + 4^2 =
       (4 - x)^2 + (4 - 1.1)^2. It is not a vertex. */
    const double x = 2.9 * 2.9 / 8;
    assert_true(gaps.farthest_m < hypot(x, 4) + 1e-5 && gaps.farthest_m + gaps.farthest_error_m > hypot(x, 4) - 1e-5);
    assert_true(fabs(gaps.farthest_at_m[0] - 100 - x) < 3e-3 && fabs(gaps.farthest_at_m[1] - 4) < 1e-3);
    assert_true(fabs(gaps.farthest_at_m[2] - 7) < 1e-5);
    /* next_m, the largest distance from a sensor to its nearest other one along the surface: 4 m, between the first two. Those
       are 1.1 m apart only through the plate. */
    assert_true(fabs(gaps.next_m - 4) < 1e-6);
    assert_int_equal(gaps.next_tags[0], 0);
    assert_int_equal(gaps.next_tags[1], 1);
    /* a point counts as far from sensors from far_m on; default: a fifth of the asset's size (here its diagonal) */
    assert_true(fabs(gaps.far_m - side_m * sqrt(2) / 5) < 1e-6);
    assert_true(gaps.lost_share == 0);
}

TEST_WITH(test_shares_are_of_the_area, set_up, tear_down)
{
    static const double limits_m[] = { 0.53, 1.03, 2.27, 3.73 };
    for (int i = 0; i < 4; i++) {
        struct sensor_coverage gaps = find(*state, INFINITY, limits_m[i], (uint8_t[SENSORS]){ 1, 1, 1 });
        assert_true(fabs(gaps.far_share - share_of(is_far, limits_m[i])) < 1e-3);
        assert_true(gaps.far_m == limits_m[i]);
        gaps = find(*state, limits_m[i], 0, (uint8_t[SENSORS]){ 0, 1, 1 });
        assert_true(fabs(gaps.lost_share - share_of(is_lost, limits_m[i])) < 1e-3);
        assert_true(fabs(gaps.far_m - limits_m[i] / 2) < 1e-12); /* half of the reach */
    }
    assert_true(find(*state, INFINITY, 0, (uint8_t[SENSORS]){ 0 }).lost_share == 1);
}

TEST_ON(struct toy *toy, test_a_sensor_that_is_tried_out_counts, set_up, tear_down)
{
    struct trial trial = { .id = 1, .count = 1, .sensors = { { .tag = 2, .asset = 0, .surface_m = { 0, 4, 0 }, .number = 1 } } };
    struct sensor_coverage_query order = {
        .scene = &toy->scene, .trial = &trial, .mode = DISTANCE_EUCLIDEAN, .reach_m = INFINITY, .good = (uint8_t[SENSORS]){ 1, 1, 1 }
    };
    struct sensor_coverage gaps;
    trial.sensors[0].vertex = CELLS * (CELLS + 1);
    trial.sensors[0].place_m[0] = 100;
    assert_true(sensor_coverage_find(&order, &gaps));
    /* sensor 0 has been moved, so the corner where it was is now the farthest point */
    assert_true(fabs(gaps.farthest_m - 4) < 1e-6 && fabs(gaps.farthest_at_m[0] - 104) < 1e-5);
    trial.sensors[0].asset = 1; /* the trial puts sensor 0 onto the other asset, which otherwise has no sensor */
    order.asset = 1;
    trial.sensors[0].vertex = 0;
    memset(trial.sensors[0].surface_m, 0, sizeof(trial.sensors[0].surface_m));
    assert_true(sensor_coverage_find(&order, &gaps));
    assert_int_equal(gaps.sensors, 1);
    assert_int_equal(gaps.next_tags[0], -1);
    order.trial = NULL;
    assert_false(sensor_coverage_find(&order, &gaps));
}

/* Asserts that the message `gaps` about the plate is this text. */
static void assert_message(const struct toy *toy, const struct sensor_coverage *gaps, const char *want)
{
    struct sensor_coverage_answer answer = { .seq = 6, .count = 1 };
    answer.assets = mem_array(1, sizeof(*answer.assets));
    answer.assets[0].coverage = *gaps;
    char *text = coverage_text(&toy->scene, NULL, &answer);
    assert_string_equal(text, want);
    mem_free(text);
    mem_free(answer.assets);
}

/* Distances from assumed positions would be wrong, so there are none. */
TEST_ON(struct toy *toy, test_assumed_positions_have_no_distances, set_up, tear_down)
{
    for (int i = 0; i < SENSORS; i++)
        toy->plant.tags[i].place.assumed = true;
    toy->scene.assets[0].sensors[0].surface_distance_m = 3;
    struct sensor_coverage gaps = find(toy, 1, 0, (uint8_t[SENSORS]){ 0, 1, 1 });
    assert_true(gaps.assumed && gaps.sensors == SENSORS);
    assert_true(gaps.farthest_m == 0 && gaps.far_share == 0 && gaps.lost_share == 0 && gaps.next_m == 0);
    assert_message(toy, &gaps,
                   "{\"type\":\"gaps\",\"seq\":6,\"group\":\"temperature\",\"far\":[],"
                   "\"assets\":[{\"asset\":\"PLATE\",\"sensors\":3,\"assumed\":true}]}");
    toy->plant.tags[0].place.assumed = false; /* the known position counts, and the assumed ones do not */
    gaps = find(toy, INFINITY, 0, (uint8_t[SENSORS]){ 1, 1, 1 });
    assert_true(!gaps.assumed && gaps.sensors == 1);
    assert_true(fabs(gaps.farthest_m - 4 * sqrt(2)) < 1e-5);
}

/* With shepard, a sensor of strength 0 has no effect on the field, so it covers nothing. */
TEST_ON(struct toy *toy, test_a_sensor_of_strength_0_covers_nothing, set_up, tear_down)
{
    toy->plant.tags[2].strength = 0;
    struct sensor_coverage gaps = find(toy, 2, 0, (uint8_t[SENSORS]){ 1, 1, 1 });
    print_message("farthest %.4f m, lost %.4f\n", gaps.farthest_m, gaps.lost_share);
    assert_int_equal(gaps.sensors, 2);
    assert_true(fabs(gaps.farthest_m - hypot(2, 4)) < 1e-3);
    assert_true(fabs(gaps.lost_share - (1 - 2 * M_PI / 16)) < 1e-3); /* all but two quarters of a disc with a radius of 2 m */
    assert_true(fabs(gaps.next_m - 4) < 1e-6);
    toy->plant.groups[0].interpolation = INTERPOLATION_PAPER;
    assert_int_equal(find(toy, 2, 0, (uint8_t[SENSORS]){ 1, 1, 1 }).sensors, SENSORS);
    toy->plant.groups[0].interpolation = INTERPOLATION_SHEPARD;
    toy->plant.tags[0].strength = toy->plant.tags[1].strength = 0;
    assert_false(
        sensor_coverage_find(&(struct sensor_coverage_query){ .scene = &toy->scene, .reach_m = 2, .good = (uint8_t[SENSORS]){ 1 } },
                             &gaps));
}

/* --- large faces ------------------------------------------------------------------------------------------------------------- */

struct plate { /* a rectangular plate of two triangles or of a few more, with sensors on it that are on trial */
    struct toy *toy;
    double origin_m[3], u_m[3], v_m[3]; /* a corner, and the sides that begin there */
    struct trial trial;
    uint8_t good[TRIAL_SENSORS];
};

static void plate_init(struct plate *plate, const double u_m[3], const double v_m[3], int cells, size_t count)
{
    static const double corner[TRIAL_SENSORS][3] = { 0 };
    struct test_shape shape = { 0 };
    *plate = (struct plate){ .toy = toy_create(), .trial = { .id = 1, .count = count } };
    memcpy(plate->u_m, u_m, sizeof(plate->u_m));
    memcpy(plate->v_m, v_m, sizeof(plate->v_m));
    shape_plate(&shape, TOY_STEEL, plate->origin_m, u_m, v_m, cells);
    toy_add(plate->toy, "PLATE", &shape, plate->origin_m, corner, count);
}

/* Places a sensor at the position a u + b v. along: with distances along the surface, which are straight lines on a plate; otherwise
   these are not known yet. */
static void plate_put(struct plate *plate, int sensor, double a, double b, bool good, bool along)
{
    const struct asset_view *view = &plate->toy->scene.assets[0].file->view;
    struct trial_sensor *to = &plate->trial.sensors[sensor];
    float *along_m = along ? mem_array(view->header->vertex_count, sizeof(*along_m)) : NULL;
    *to = (struct trial_sensor){ .tag = sensor, .number = (uint32_t)sensor };
    for (int c = 0; c < 3; c++)
        to->surface_m[c] = (float)(a * plate->u_m[c] + b * plate->v_m[c]);
    for (uint32_t v = 1; v < view->header->vertex_count; v++)
        if (vecf_distance(view->positions_m[v], to->surface_m) < vecf_distance(view->positions_m[to->vertex], to->surface_m))
            to->vertex = v;
    for (uint32_t v = 0; along && v < view->header->vertex_count; v++)
        along_m[v] = vecf_distance(view->positions_m[v], to->surface_m);
    to->reach = along ? trial_reach_create(along_m) : NULL;
    plate->good[sensor] = good;
}

static struct sensor_coverage plate_find(const struct plate *plate, enum distance_mode mode, double reach_m, double far_m)
{
    struct sensor_coverage found;
    struct sensor_coverage_query query = {
        .scene = &plate->toy->scene, .trial = &plate->trial, .mode = mode, .reach_m = reach_m, .far_m = far_m, .good = plate->good
    };
    assert_true(sensor_coverage_find(&query, &found));
    return found;
}

static void plate_finish(struct plate *plate)
{
    for (size_t i = 0; i < plate->trial.count; i++)
        trial_reach_unref(&plate->trial.sensors[i].reach);
    toy_destroy(&plate->toy);
}

/* Four sensors in the corners of two triangles: all vertices are at a sensor, but the middle of the plate is far from all. */
TEST(test_the_middle_of_two_triangles_is_far_from_their_corners)
{
    struct plate plate;
    for (int along = 0; along < 2; along++) {
        plate_init(&plate, (double[3]){ 6, 0, 0 }, (double[3]){ 0, 4, 0 }, 1, 4);
        for (int i = 0; i < 4; i++)
            plate_put(&plate, i, i % 2, i / 2, i > 0, along);
        struct sensor_coverage found = plate_find(&plate, along ? DISTANCE_GEODESIC : DISTANCE_EUCLIDEAN, INFINITY, 1);
        print_message("farthest %.4f m (+ %.4f), far %.5f, lost %.5f\n", found.farthest_m, found.farthest_error_m, found.far_share,
                      found.lost_share);
        assert_true(found.farthest_m <= hypot(3, 2) + 1e-5 && found.farthest_m + found.farthest_error_m >= hypot(3, 2) - 1e-5);
        assert_true(found.farthest_error_m < 1e-3);
        assert_true(fabs(found.farthest_at_m[0] - 3) < 2e-3 && fabs(found.farthest_at_m[1] - 2) < 2e-3);
        assert_true(fabs(found.far_share - (1 - M_PI / 24)) < 3e-4); /* four quarters of a disc with a radius of 1 m are near */
        assert_true(fabs(found.lost_share - 0.25) < 1e-4);           /* the quarter around the sensor without a reading */
        assert_true(found.unsure_share == 0);
        assert_true(fabs(found.next_m - 4) < 1e-5);
        found = plate_find(&plate, along ? DISTANCE_GEODESIC : DISTANCE_EUCLIDEAN, 1.5, 0);
        assert_true(fabs(found.lost_share - (1 - 0.75 * M_PI * 1.5 * 1.5 / 24)) < 1e-3);
        plate_finish(&plate);
    }
}

/* A sensor inside a triangle covers the disc around it, although all corners are far from it. */
TEST(test_a_sensor_inside_a_triangle_covers_its_surroundings)
{
    struct plate plate;
    plate_init(&plate, (double[3]){ 6, 0, 0 }, (double[3]){ 0, 4, 0 }, 1, 2);
    plate_put(&plate, 0, 0.6, 0.4, true, false);
    plate_put(&plate, 1, 0.6, 0.6, true, false);
    struct sensor_coverage found = plate_find(&plate, DISTANCE_EUCLIDEAN, 0.25, 0.25);
    assert_true(fabs(found.far_share - (1 - 2 * M_PI / 16 / 24)) < 1e-4 && fabs(found.lost_share - found.far_share) < 1e-4);
    assert_true(fabs(found.farthest_m - hypot(3.6, 1.6)) < 1e-5);
    assert_true(fabs(found.next_m - 0.8) < 1e-5); /* the distance of the sensors, not of their nearest vertices */
    plate_finish(&plate);
}

/* No path connects the second plate with a sensor: it counts as far and as lost, but not as the farthest point. */
TEST(test_parts_that_no_path_reaches)
{
    struct plate plate = { .toy = toy_create(), .good = { 1 }, .trial = { .id = 1, .count = 1 } };
    struct test_shape shape = { 0 };
    shape_plate(&shape, TOY_STEEL, (double[3]){ 0, 0, 0 }, (double[3]){ 3, 0, 0 }, (double[3]){ 0, 3, 0 }, 1);
    shape_plate(&shape, TOY_STEEL, (double[3]){ 9, 0, 0 }, (double[3]){ 1, 0, 0 }, (double[3]){ 0, 1, 0 }, 1);
    toy_add(plate.toy, "PLATES", &shape, (double[3]){ 0, 0, 0 }, &plate.origin_m, 1);
    const struct asset_view *view = &plate.toy->scene.assets[0].file->view;
    float *along_m = mem_array(view->header->vertex_count, sizeof(*along_m));
    for (uint32_t v = 0; v < view->header->vertex_count; v++)
        along_m[v] = view->positions_m[v][0] > 8 ? INFINITY : vecf_distance(view->positions_m[v], (float[3]){ 0, 0, 0 });
    plate.trial.sensors[0].reach = trial_reach_create(along_m);
    struct sensor_coverage found = plate_find(&plate, DISTANCE_GEODESIC, INFINITY, 5);
    assert_true(fabs(found.farthest_m - 3 * sqrt(2)) < 1e-5);
    assert_true(fabs(found.far_share - 0.1) < 1e-6 && fabs(found.lost_share - 0.1) < 1e-6);
    plate_finish(&plate);
}

/* Three sensors in one place, of which one is lost: the others cover the plate. */
TEST(test_sensors_in_one_place)
{
    struct plate plate;
    for (int lost = 0; lost < 3; lost++) {
        plate_init(&plate, (double[3]){ 6, 0, 0 }, (double[3]){ 0, 4, 0 }, 1, 3);
        for (int i = 0; i < 3; i++)
            plate_put(&plate, i, 0.5, 0.4, i != lost, false);
        struct sensor_coverage found = plate_find(&plate, DISTANCE_EUCLIDEAN, INFINITY, 1);
        assert_true(found.lost_share == 0 && found.unsure_share == 0);
        assert_true(fabs(found.far_share - (1 - M_PI / 24)) < 1e-3);
        plate_finish(&plate);
    }
}

/* If the work limit is reached, unsure_share and farthest_error_m bound the errors. */
TEST(test_the_work_limit_is_stated)
{
    struct plate plate;
    plate_init(&plate, (double[3]){ 6, 0, 0 }, (double[3]){ 0, 4, 0 }, 1, 4);
    for (int i = 0; i < 4; i++)
        plate_put(&plate, i, i % 2, i / 2, i > 0, false);
    for (long work = 1; work < 2000; work *= 3) {
        struct sensor_coverage found;
        struct sensor_coverage_query query = { .scene = &plate.toy->scene,
                                               .trial = &plate.trial,
                                               .mode = DISTANCE_EUCLIDEAN,
                                               .reach_m = INFINITY,
                                               .far_m = 1,
                                               .work = work,
                                               .good = plate.good };
        assert_true(sensor_coverage_find(&query, &found));
        print_message("%ld evaluations: far %.4f, lost %.4f, unsure %.4f, farthest %.4f m (+ %.4f)\n", work, found.far_share,
                      found.lost_share, found.unsure_share, found.farthest_m, found.farthest_error_m);
        assert_true(work > 100 || (found.unsure_share > 0 && found.farthest_error_m > 0.1));
        assert_true(fabs(found.far_share - (1 - M_PI / 24)) < found.unsure_share + 1e-3);
        assert_true(fabs(found.lost_share - 0.25) < found.unsure_share + 1e-3);
        assert_true(found.farthest_m < hypot(3, 2) + 1e-5 && found.farthest_m + found.farthest_error_m > hypot(3, 2) - 1e-5);
    }
    plate_finish(&plate);
}

/* Random plates with random sensors, compared with dense samples. */
TEST(test_random_plates_against_dense_samples)
{
    struct plate plate;
    srand48((long)sweep_seed());
    for (int n = sweep(300, 30), i = 0; i < n; i++) {
        const bool along = i % 2 == 1;
        const int count = 1 + (int)(12 * drand48() * drand48());
        const double long_m = 0.5 + 10 * drand48(), wide_m = 0.02 + 5 * drand48() * drand48(), slope = drand48();
        const double far_m = long_m * (0.05 + 0.5 * drand48()), reach_m = i % 3 == 0 ? (double)INFINITY : long_m * (0.1 + 0.5 * drand48());
        double at[TRIAL_SENSORS][2], farthest_m = 0, far = 0, lost = 0;
        plate_init(&plate, (double[3]){ long_m, slope, 0 }, (double[3]){ -slope * wide_m / long_m, wide_m, 0.3 * wide_m }, 1 + i % 4,
                   (size_t)count);
        for (int s = 0; s < count; s++) {
            at[s][0] = drand48();
            at[s][1] = drand48();
            plate_put(&plate, s, at[s][0], at[s][1], drand48() < 0.7, along);
        }
        struct sensor_coverage found = plate_find(&plate, along ? DISTANCE_GEODESIC : DISTANCE_EUCLIDEAN, reach_m, far_m);
        const double u_m = vec_length(plate.u_m), v_m = vec_length(plate.v_m); /* u and v are orthogonal */
        for (int a = 0; a < SAMPLES / 2; a++)
            for (int b = 0; b < SAMPLES / 2; b++) {
                double good_m = INFINITY, bad_m = INFINITY;
                for (int s = 0; s < count; s++) {
                    double m = hypot(u_m * (at[s][0] - (a + 0.5) / (SAMPLES / 2)), v_m * (at[s][1] - (b + 0.5) / (SAMPLES / 2)));
                    *(plate.good[s] ? &good_m : &bad_m) = fmin(plate.good[s] ? good_m : bad_m, m);
                }
                farthest_m = fmax(farthest_m, fmin(good_m, bad_m));
                far += fmin(good_m, bad_m) > far_m;
                lost += good_m > fmin(reach_m, bad_m) || isinf(good_m);
            }
        far /= SAMPLES * SAMPLES / 4;
        lost /= SAMPLES * SAMPLES / 4;
        const double step_m = hypot(u_m, v_m) / SAMPLES;
        if (fabs(found.far_share - far) > 4e-3 || fabs(found.lost_share - lost) > 4e-3 ||
            fabs(found.farthest_m - farthest_m) > step_m + 1e-3)
            print_message("plate %d, %g x %g m, %d sensors: far %.4f (samples: %.4f), lost %.4f (%.4f), farthest %.4f m (%.4f)\n", i, u_m,
                          v_m, count, found.far_share, far, found.lost_share, lost, found.farthest_m, farthest_m);
        assert_true(fabs(found.far_share - far) < 4e-3 && fabs(found.lost_share - lost) < 4e-3);
        assert_true(found.farthest_m > farthest_m - found.farthest_error_m - 1e-3 && found.farthest_m < farthest_m + step_m + 1e-3);
        assert_true(found.unsure_share == 0 && found.farthest_error_m < 1e-3 * long_m);
        plate_finish(&plate);
    }
}
