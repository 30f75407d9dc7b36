/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Suggested positions of sensors on a plate of two triangles: they lie inside the triangles, and gain as much as those that a
   brute-force search finds. tests/unit/influence_field_test.c tests suggestions on a fine mesh. */
#include "placing/sensor_suggest.h"

#include "tests/support/test.h"

#include "tests/support/toy.h"

enum { SENSORS = 4, GRID = 60 };
static const double long_m = 6, wide_m = 4, sensors[SENSORS][3] = { { 0, 0, 0 }, { 6, 0, 0 }, { 0, 4, 0 }, { 6, 4, 0 } };

/* Returns how much a sensor at (x, y) would reduce the measure (sensor_suggest.h), from samples of the plate. */
static double gain_of(double x, double y, double seen_m)
{
    double gain = 0;
    for (int i = 0; i < GRID; i++)
        for (int j = 0; j < GRID; j++) {
            double at[2] = { long_m * (i + 0.5) / GRID, wide_m * (j + 0.5) / GRID }, near_m = INFINITY;
            for (int s = 0; s < SENSORS; s++)
                near_m = fmin(near_m, hypot(at[0] - sensors[s][0], at[1] - sensors[s][1]));
            double now_m = fmin(near_m, hypot(at[0] - x, at[1] - y));
            gain += fmin(1, near_m * near_m / seen_m / seen_m) - fmin(1, now_m * now_m / seen_m / seen_m);
        }
    return gain / GRID / GRID;
}

TEST(test_a_suggestion_lies_inside_a_large_triangle)
{
    struct toy *toy = toy_create();
    struct workers *workers = test_workers(1);
    struct log *the_log = test_log();
    struct test_shape shape = { 0 };
    struct suggestion found[2];
    double best = 0, unseen = 0;
    shape_plate(&shape, TOY_STEEL, (double[3]){ 0, 0, 0 }, (double[3]){ long_m, 0, 0 }, (double[3]){ 0, wide_m, 0 }, 1);
    toy_add(toy, "PLATE", &shape, (double[3]){ 100, 0, 0 }, sensors, SENSORS);
    toy->plant.groups[0].hot_spot_m = 0.8;
    const double seen_m = 0.8 * sqrt(2 * log(20));
    const struct suggest_query query = { the_log, workers, &toy->scene, temp_folder(), 0, -1, 2 };
    size_t count = sensor_suggest(&query, found);
    for (size_t i = 0; i < count; i++)
        print_message("%.2f, %.2f: %.4f to %.4f, unseen %.4f\n", found[i].at_m[0] - 100, found[i].at_m[1], found[i].before, found[i].after,
                      found[i].unseen_before);
    assert_int_equal(count, 2);
    for (int i = 0; i <= GRID; i++)
        for (int j = 0; j <= GRID; j++)
            best = fmax(best, gain_of(long_m * i / GRID, wide_m * j / GRID, seen_m));
    print_message("the best position gains %.4f\n", best);
    assert_true(fabs(found[0].at_m[0] - 100 - long_m / 2) < 0.3 && fabs(found[0].at_m[1] - wide_m / 2) < 0.3);
    assert_true(fabs(found[0].before - found[0].after - best) < 0.02 * best);
    unseen = 1 - M_PI * seen_m * seen_m / (long_m * wide_m);
    assert_true(fabs(found[0].unseen_before - unseen) < 0.02); /* all but four quarters of a disc */
    assert_true(found[1].after < found[0].after && found[1].before == found[0].after);
    toy_destroy(&toy);
}
