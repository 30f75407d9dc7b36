/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sensor coverage (how far the points of an asset are from sensors) of a plate, compared with values computed by hand and with
   a plain sum over vertices. */
#include "placing/sensor_coverage.h"

#include "tests/support/test.h"

#include "tests/support/toy.h"

enum { CELLS = 40, SENSORS = 3 };
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

/* Returns the share of the plate's area where f(nearest sensor, limit_m) holds. Each vertex of the grid stands for the area
   around it. */
static double share_of(bool (*f)(const double nearest[2], double limit_m), double limit_m)
{
    double hit = 0, all = 0;
    for (int i = 0; i <= CELLS; i++)
        for (int j = 0; j <= CELLS; j++) {
            double x = side_m * i / CELLS, y = side_m * j / CELLS, nearest[2] = { INFINITY, 0 };
            int inside = (i > 0 && i < CELLS) + (j > 0 && j < CELLS);
            /* area around the vertex, in sixths of a grid square: 6 inside, 3 at an edge, 1.5 at a corner (on average, as a
               square's diagonal may or may not end there) */
            double triangles = inside ? 3 * inside : 1.5;
            for (int s = 0; s < SENSORS; s++) {
                double m = hypot(x - sensors[s][0], y - sensors[s][1]);
                /* nearest[]: distance and number of the nearest sensor; of two equally near ones the later counts, because the
                   last one is the good one */
                if (m <= nearest[0]) {
                    nearest[0] = m;
                    nearest[1] = s;
                }
            }
            all += triangles;
            hit += f(nearest, limit_m) ? triangles : 0;
        }
    return hit / all;
}

static bool is_far(const double nearest[2], double limit_m)
{
    return nearest[0] > limit_m + 1e-6;
}

static bool is_lost(const double nearest[2], double limit_m)
{
    return nearest[0] > limit_m + 1e-6 || nearest[1] == 0;
}

TEST_WITH(test_the_farthest_place_and_the_next_sensor, set_up, tear_down)
{
    struct sensor_coverage gaps = find(*state, INFINITY, 0, (uint8_t[SENSORS]){ 1, 1, 1 });
    assert_int_equal(gaps.sensors, SENSORS);
    /* the farthest point of the plate from any sensor is (1, 4): its nearest is the first sensor, but the third is hardly
       farther away */
    assert_true(fabs(gaps.farthest_m - hypot(1, 4)) < 1e-6);
    assert_true(fabs(gaps.farthest_at_m[0] - 101) < 1e-5 && fabs(gaps.farthest_at_m[1] - 4) < 1e-5);
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
