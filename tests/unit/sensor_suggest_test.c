/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Suggested positions of sensors on a plate of two triangles: they lie inside the triangles, and gain as much as those that a
   brute-force search finds. Suggestions on two separate plates, measured like the view `show: blind`.
   tests/unit/influence_field_test.c tests suggestions on a fine mesh. */
#include "placing/sensor_suggest.h"

#include "tests/support/test.h"

#include "field/field.h"
#include "protocol/asset_distance.h"
#include "tests/support/whole_field.h"
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

/* --- two separate plates ----------------------------------------------------------------------------------------------------- */

enum { CELLS = 60 };
static const double apart_m = 0.2, on_first[1][3] = { { 0.5, 0.5, 0 } };

/* Returns one asset of two plates of 1 m², one above the other, with a sensor in the middle of the first one. No path along the
   surface connects the plates. */
static struct toy *plates_create(void)
{
    struct toy *toy = toy_create();
    struct test_shape shape = { 0 };
    for (int i = 0; i < 2; i++)
        shape_plate(&shape, TOY_STEEL, (double[3]){ 0, 0, i * apart_m }, (double[3]){ 1, 0, 0 }, (double[3]){ 0, 1, 0 }, CELLS);
    toy_add(toy, "PLATES", &shape, (double[3]){ 0, 0, 0 }, on_first, 1);
    const struct asset_view *view = &toy->scene.assets[0].file->view;
    for (size_t v = 0; v < view->header->vertex_count; v++)
        if (view->positions_m[v][2] > 0.1f)
            ((uint16_t *)asset_distance_codes(view, 0, v))[v % ASSET_DISTANCE_BLOCK] = ASSET_DISTANCE_NONE;
    toy->plant.groups[0].hot_spot_m = 0.15;
    return toy;
}

/* Returns the share of the vertices where `show: blind` shows the full range or more. */
static double blind_share(const struct toy *toy, struct workers *workers)
{
    struct snapshot *snapshot = toy_snapshot(toy);
    struct field *field = field_create(workers, &toy->scene);
    struct field_params params = { 0 };
    size_t hit = 0;
    toy_set(snapshot, 0, 50, 0);
    field_params_default(&toy->plant, 0, &params);
    field_params_set_show(&toy->plant, &params, SHOW_BLIND);
    const struct scalars *scalars = field_scalars(field, 0, &params, snapshot);
    assert_non_null(scalars);
    for (size_t v = 0; v < scalars->count; v++)
        hit += scalars->at[v].value >= 100;
    double share = (double)hit / (double)scalars->count;
    field_destroy(&field);
    snapshot_destroy(&snapshot);
    return share;
}

TEST(test_distances_are_those_of_the_view_of_blind_spots)
{
    struct toy *toy = plates_create();
    struct workers *workers = test_workers(1);
    const struct suggest_query query = { test_log(), workers, &toy->scene, temp_folder(), 0, -1, 1 };
    const double seen_m = 0.15 * sqrt(2 * log(20)), on_m2 = M_PI * seen_m * seen_m, beside_m2 = on_m2 - M_PI * apart_m * apart_m;
    for (int straight = 0; straight < 2; straight++) {
        struct suggestion found;
        toy->plant.groups[0].distance = straight ? DISTANCE_EUCLIDEAN : DISTANCE_GEODESIC;
        assert_int_equal(sensor_suggest(&query, &found), 1);
        double blind = blind_share(toy, workers), unseen = 1 - (on_m2 + straight * beside_m2) / 2;
        print_message("%s: unseen %.4f to %.4f, blind vertices %.4f, by hand %.4f\n", straight ? "straight" : "along", found.unseen_before,
                      found.unseen_after, blind, unseen);
        assert_true(fabs(found.unseen_before - unseen) < 0.01 && fabs(found.unseen_before - blind) < 0.02);
        assert_true(found.unseen_after < found.unseen_before - 0.1);
    }
    /* a sensor of strength 0 has no effect on the field, so it detects nothing */
    struct suggestion found;
    toy->plant.tags[0].strength = 0;
    assert_int_equal(sensor_suggest(&query, &found), 1);
    assert_true(found.unseen_before > 1 - 1e-9 && found.unseen_after < 0.9);
    toy_destroy(&toy);
}
