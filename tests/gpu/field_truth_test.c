/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rules of truth in pixels: lost sensors, readings out of range, points out of reach, and absurd values. Five sensors on
   one plate, and a second, unconnected plate of the same asset. */
#include "tests/support/test.h"

#include "protocol/asset_distance.h"
#include "render/shaded_colormap.h"
#include "tests/support/stand_case.h"
#include "value/quality.h"

enum { CELLS = 16, GRID = CELLS + 1, WIDTH_PX = 384, HEIGHT_PX = 192, SENSORS = 5, HOTTEST = 4 };
static const double side_m = 4;
static const double places[SENSORS][3] = { { 0, 0, 0 }, { 4, 0, 0 }, { 0, 4, 0 }, { 4, 4, 0 }, { 2, 2, 0 } };

static int set_up(void **state)
{
    struct test_shape shape = { 0 };
    struct toy *toy = toy_create();
    (void)state;
    shape_plate(&shape, TOY_STEEL, (double[3]){ 0, 0, 0 }, (double[3]){ side_m, 0, 0 }, (double[3]){ 0, side_m, 0 }, CELLS);
    shape_plate(&shape, TOY_STEEL, (double[3]){ side_m, 0, 0 }, (double[3]){ side_m, 0, 0 }, (double[3]){ 0, side_m, 0 }, CELLS);
    toy_add(toy, "PLATES", &shape, (double[3]){ 0, 0, 0 }, places, SENSORS);
    const struct asset_view *view = &toy->scene.assets[0].file->view;
    for (size_t i = 0; i < SENSORS; i++)
        for (size_t v = GRID * GRID; v < view->header->vertex_count; v++)
            ((uint16_t *)asset_distance_codes(view, i, v))[v % ASSET_DISTANCE_BLOCK] = ASSET_DISTANCE_NONE;
    stand_init(&stand, &rig, toy);
    for (int i = 0; i < SENSORS; i++)
        toy_set(stand.snapshot, i, i == HOTTEST ? 95 : 20 + i, QUALITY_GOOD);
    return 0;
}

/* Makes a view from above with both plates filling the image. */
static void look_down(struct view *view, enum tier tier)
{
    view_default(&stand.toy->scene, WIDTH_PX, HEIGHT_PX, view);
    view->camera = (struct camera){ .eye_m = { side_m, side_m / 2, 10 }, .target_m = { side_m, side_m / 2, 0 }, .up = { 0, 1, 0 } };
    view->camera.fov_deg = 2 * atan(side_m / 2 / 10) * 180 / M_PI;
    view->look = LOOK_FLAT;
    view->tier = tier;
}

/* Returns the pixel at (x_m, y_m), in metres from the lower left corner of the plates; clamped to 2 pixels inside the frame. */
static const uint8_t *pixel_at(const struct frame *frame, double x_m, double y_m)
{
    int x = (int)(x_m / side_m * HEIGHT_PX), y = (int)((side_m - y_m) / side_m * HEIGHT_PX);
    x = x < 2 ? 2 : x > WIDTH_PX - 3 ? WIDTH_PX - 3 : x;
    y = y < 2 ? 2 : y > HEIGHT_PX - 3 ? HEIGHT_PX - 3 : y;
    return frame_pixel(frame, x, y);
}

/* Draws a frame. Returns the map's index of the colour at (x_m, y_m), or -1 if the map lacks it. Refined frames average
   samples, so there the nearest colour of the map counts, unless the pixel is grey. */
static int shown_at(const struct view *view, double x_m, double y_m)
{
    struct frame *frame = stand_draw(&stand, view);
    const uint8_t *pixel = pixel_at(frame, x_m, y_m);
    int index = map_index_exact(colormap_at(NULL, 0), pixel);
    if (index < 0 && view->tier == TIER_REFINED && !is_grey(pixel))
        index = map_index_nearest(colormap_at(NULL, 0), pixel, false);
    frame_unref(&frame);
    return index;
}

/* Returns whether a square on the first plate is grey everywhere, which means hatched. */
static bool is_hatched(const struct view *view, double x_m, double y_m, double half_m)
{
    struct frame *frame = stand_draw(&stand, view);
    bool all = true;
    for (double y = y_m - half_m; y <= y_m + half_m; y += 0.05)
        for (double x = x_m - half_m; x <= x_m + half_m; x += 0.05)
            all = all && is_grey(pixel_at(frame, x, y));
    frame_unref(&frame);
    return all;
}

static const enum tier tiers[] = { TIER_PREVIEW, TIER_REFINED };
#define for_each_tier(view) for (int tier_index = 0; tier_index < 2 && (look_down(view, tiers[tier_index]), true); tier_index++)

TEST_WITH(test_the_hottest_goes_bad, set_up, stand_tear_down)
{
    struct view view;
    for_each_tier(&view)
    {
        toy_set(stand.snapshot, HOTTEST, 95, QUALITY_GOOD);
        assert_in_range(shown_at(&view, 2, 2), 235, 245);
        toy_set(stand.snapshot, HOTTEST, 95, QUALITY_BAD_SENSOR_FAILURE);
        assert_true(is_hatched(&view, 2, 2, 0.7));
        /* near the other sensors the colours stay, and the lost sensor's last reading of 95 has no effect on them */
        assert_in_range(shown_at(&view, 0.3, 0.3), 45, 62);
        view.field.fill = FILL_NEIGHBOURS;
        /* with FILL_NEIGHBOURS the other sensors' values fill the gap, which is stippled instead of hatched */
        assert_false(is_hatched(&view, 2, 2, 0.7));
        struct frame *frame = stand_draw(&stand, &view);
        int dots = 0;
        for (double y = 1.5; y < 2.5; y += 0.021)
            for (double x = 1.5; x < 2.5; x += 0.021)
                dots += abs(pixel_at(frame, x, y)[1] - colormap_uncertain[1]) < 12;
        assert_in_range(dots, 100, 1200);
        frame_unref(&frame);
    }
}

TEST_WITH(test_a_reading_of_zero_is_a_reading, set_up, stand_tear_down)
{
    struct view view;
    for_each_tier(&view)
    {
        for (int i = 0; i < SENSORS; i++)
            toy_set(stand.snapshot, i, 0.0, QUALITY_GOOD);
        assert_int_equal(shown_at(&view, 2, 2), 0);
        assert_int_equal(shown_at(&view, 1, 3), 0);
        toy_set(stand.snapshot, HOTTEST, -0.5, QUALITY_GOOD);
        struct frame *frame = stand_draw(&stand, &view);
        assert_true(is_color(pixel_at(frame, 2.02, 2.02), colormap_at(NULL, 0)->below));
        frame_unref(&frame);
    }
}

TEST_WITH(test_all_bad, set_up, stand_tear_down)
{
    struct view view;
    for (int i = 0; i < SENSORS; i++)
        toy_set(stand.snapshot, i, 50, QUALITY_BAD_NO_COMMUNICATION);
    for_each_tier(&view) assert_true(is_hatched(&view, 2, 2, 1.9));
}

TEST_WITH(test_one_sensor_is_everywhere_it_reaches, set_up, stand_tear_down)
{
    struct view view;
    for_each_tier(&view)
    {
        for (int i = 0; i < HOTTEST; i++)
            toy_set(stand.snapshot, i, 10, QUALITY_BAD_OUT_OF_SERVICE);
        toy_set(stand.snapshot, HOTTEST, 60, QUALITY_GOOD);
        assert_int_equal(shown_at(&view, 2, 2), 153);
        assert_int_equal(shown_at(&view, 2.5, 2.4), 153);
        assert_true(is_hatched(&view, 0.2, 0.2, 0.2)); /* the area around a lost sensor is hatched */
    }
}

TEST_WITH(test_a_part_that_nobody_reaches, set_up, stand_tear_down)
{
    struct view view;
    for_each_tier(&view)
    {
        /* hatched: no path along the surface leads from a sensor to the second plate */
        assert_true(is_hatched(&view, 1.5 * side_m, 2, 1.8));
        assert_true(shown_at(&view, 3.5, 2) >= 0);
        view.field.distance = DISTANCE_EUCLIDEAN; /* straight-line distances reach the second plate, too */
        assert_false(is_hatched(&view, 1.5 * side_m, 2, 1.8));
        view.field.reach_m = 1;
        assert_true(is_hatched(&view, 1.5 * side_m + 1, 2, 0.8));
        assert_false(is_hatched(&view, 2, 2, 0.2));
    }
}

TEST_WITH(test_what_is_not_a_number_has_no_color, set_up, stand_tear_down)
{
    static const double mad[] = { NAN, INFINITY, -INFINITY };
    struct view view;
    for_each_tier(&view) for (int i = 0; i < 3; i++)
    {
        toy_set(stand.snapshot, HOTTEST, mad[i], QUALITY_GOOD);
        assert_true(is_hatched(&view, 2, 2, 0.7));
        assert_in_range(shown_at(&view, 0.3, 0.3), 45, 62);
    }
}

TEST_WITH(test_beyond_the_range, set_up, stand_tear_down)
{
    struct view view;
    for_each_tier(&view)
    {
        toy_set(stand.snapshot, HOTTEST, 1e9, QUALITY_GOOD);
        struct frame *frame = stand_draw(&stand, &view);
        assert_true(is_color(pixel_at(frame, 2.02, 2.02), colormap_at(NULL, 0)->above));
        frame_unref(&frame);
        view.field.interpolation = INTERPOLATION_PAPER; /* Algorithm 1 clamps values to the range */
        assert_true(shown_at(&view, 2.02, 2.02) >= 0);
    }
}

TEST_WITH(test_a_sensor_at_a_vertex_is_exact, set_up, stand_tear_down)
{
    struct view view;
    for_each_tier(&view)
    {
        for (double power = 0.5; power <= 16; power *= 2) {
            view.field.power = power;
            /* near the sensor that reads 95, which has the map's colour 243 */
            assert_in_range(shown_at(&view, 2.002, 2.002), power < 1 ? 200 : 235, 245);
        }
        view.field.interpolation = INTERPOLATION_PAPER;
        assert_true(shown_at(&view, 2, 2) >= 0); /* the pixel has a colour of the map: the value is a number, neither 0/0 nor infinite */
    }
}

TEST_WITH(test_a_distance_is_no_reading, set_up, stand_tear_down)
{
    struct view view;
    for_each_tier(&view)
    {
        view.field.show = SHOW_DISTANCE;
        view.field.sensor = HOTTEST;
        field_default_range(&stand.toy->scene, &view.field, &view.range_min, &view.range_max);
        assert_true(view.range_max > sqrt(8) - 1e-5 && view.range_max < 4);
        toy_set(stand.snapshot, HOTTEST, 95, QUALITY_BAD_SENSOR_FAILURE);
        assert_in_range(shown_at(&view, 2.02, 2.02), 0, 4);
        int number = (int)(256 * 1.98 / view.range_max);
        assert_in_range(shown_at(&view, 3.98, 2), number - 4, number + 4);
        assert_true(is_hatched(&view, 1.5 * side_m, 2, 1.8));
    }
}
