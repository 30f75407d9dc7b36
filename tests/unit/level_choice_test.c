/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which level of detail is drawn: the coarsest that errs by less than asked for where the asset is nearest. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "render/stage.h"

/* A box of 2 m whose near side is `away` metres from the camera, with levels that err by 0, 1, 10 and 100 mm. */
static size_t chosen_within(double error_px, double away_m, double pixel_per_radian)
{
    struct model_level levels[4] = { { .error_m = 0 }, { .error_m = 0.001f }, { .error_m = 0.01f }, { .error_m = 0.1f } };
    struct model model = { .levels = levels, .level_count = 4 };
    const struct model *of_asset[1] = { &model };
    struct scene_asset asset = { .bounds_min_m = { 5 + away_m, 1, 1 }, .bounds_max_m = { 7 + away_m, 3, 3 } };
    struct scene scene = { .assets = &asset, .asset_count = 1 };
    struct stage stage = { .scene = &scene, .of_asset = of_asset };
    const struct shot shot = { .eye_m = { 5, 2, 2 }, .pixel_per_radian = pixel_per_radian };
    return (size_t)(stage_level(&stage, &shot, 0, error_px) - levels);
}

static size_t chosen(double away_m, double pixel_per_radian)
{
    return chosen_within(1, away_m, pixel_per_radian);
}

static void levels_change_within_a_pixel(void **state)
{
    (void)state;
    assert_int_equal(chosen(-1, 1000), 0); /* the camera is inside the box */
    assert_int_equal(chosen(0, 1000), 0);
    assert_int_equal(chosen(0.9, 1000), 0); /* 1 mm at 0.9 m: 1.1 pixels */
    assert_int_equal(chosen(2, 1000), 1);   /* 0.5 */
    assert_int_equal(chosen(9, 1000), 1);
    assert_int_equal(chosen(20, 1000), 2);
    assert_int_equal(chosen(200, 1000), 3);
    assert_int_equal(chosen(200, 10000), 2); /* a picture of ten times the pixels */
    assert_int_equal(chosen_within(0.5, 1.5, 1000), 0); /* 0.67 pixels are too much */
    assert_int_equal(chosen_within(0.7, 1.5, 1000), 1);
    for (double away_m = 0.01; away_m < 1000; away_m *= 1.1) {
        static const double errors_m[4] = { 0, 0.001, 0.01, 0.1 };
        assert_true(errors_m[chosen(away_m, 1500)] * 1500 / away_m <= 1);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(levels_change_within_a_pixel) };
    cmocka_set_message_output(CM_OUTPUT_TAP);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
