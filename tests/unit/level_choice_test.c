/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Selection of levels of detail: the coarsest one whose error, seen at the asset's nearest point, is below a limit in pixels;
   and the limit itself, which is lower if the frame can draw more triangles. */
#include "tests/support/test.h"

#include "render/plan/lod_selection.h"
#include "render/gl/gpu_scene.h"

/* Returns the level chosen for a box of 2 m, away_m from the camera, if errors up to error_px pixels are allowed. Its levels 0
   to 3 have errors of 0, 1, 10 and 100 mm. */
static size_t chosen_within(double error_px, double away_m, double pixel_per_radian)
{
    struct model_level levels[4] = { { .error_m = 0 }, { .error_m = 0.001f }, { .error_m = 0.01f }, { .error_m = 0.1f } };
    struct gl_model model = { .levels = levels, .level_count = 4 };
    const struct gl_model *of_asset[1] = { &model };
    struct scene_asset asset = { .bounds_min_m = { 5 + away_m, 1, 1 }, .bounds_max_m = { 7 + away_m, 3, 3 } };
    struct scene scene = { .assets = &asset, .asset_count = 1 };
    struct gpu_scene gpu_scene = { .scene = &scene, .of_asset = of_asset };
    const struct view_constants constants = { .eye_m = { 5, 2, 2 }, .pixel_per_radian = pixel_per_radian };
    return (size_t)(gpu_scene_level(&gpu_scene, &constants, 0, error_px) - levels);
}

static size_t chosen(double away_m, double pixel_per_radian)
{
    return chosen_within(1, away_m, pixel_per_radian);
}

TEST(levels_change_within_a_pixel)
{
    assert_int_equal(chosen(-1, 1000), 0); /* the camera is 1 m inside the box */
    assert_int_equal(chosen(0, 1000), 0);
    assert_int_equal(chosen(0.9, 1000), 0); /* finest level: at 0.9 m, the next one's error of 1 mm would be 1.1 pixels */
    assert_int_equal(chosen(2, 1000), 1);   /* 0.5 */
    assert_int_equal(chosen(9, 1000), 1);
    assert_int_equal(chosen(20, 1000), 2);
    assert_int_equal(chosen(200, 1000), 3);
    assert_int_equal(chosen(200, 10000), 2);            /* ten times as many pixels per radian make errors ten times as large */
    assert_int_equal(chosen_within(0.5, 1.5, 1000), 0); /* 0.67 pixels are too much */
    assert_int_equal(chosen_within(0.7, 1.5, 1000), 1);
    for (double away_m = 0.01; away_m < 1000; away_m *= 1.1) {
        static const double errors_m[4] = { 0, 0.001, 0.01, 0.1 };
        assert_true(errors_m[chosen(away_m, 1500)] * 1500 / away_m <= 1);
    }
}

/* Returns the error limit in pixels for a plant of `assets` equal boxes 10 m away. Each has levels of 1,000,000, 300,000,
   100,000 and 30,000 triangles, divided by `fewer`, with errors of 0, 2, 4 and 8 mm. In this picture 1 mm is 0.1 pixels. */
static double error_among(size_t assets, int fewer, enum tier tier)
{
    struct model_level levels[4] = { { .triangles = 1000000 / fewer },
                                     { .triangles = 300000 / fewer, .error_m = 0.002f },
                                     { .triangles = 100000 / fewer, .error_m = 0.004f },
                                     { .triangles = 30000 / fewer, .error_m = 0.008f } };
    struct gl_model model = { .levels = levels, .level_count = 4 };
    const struct gl_model **of_asset = mem_array(assets, sizeof(const struct gl_model *));
    struct scene scene = { .assets = mem_array(assets, sizeof(*scene.assets)), .asset_count = assets };
    struct gpu_scene gpu_scene = { .scene = &scene, .of_asset = of_asset };
    int *visible = mem_array(assets, sizeof(*visible));
    for (size_t i = 0; i < assets; i++) {
        of_asset[i] = &model;
        visible[i] = (int)i;
        scene.assets[i] = (struct scene_asset){ .bounds_min_m = { 10, -1, -1 }, .bounds_max_m = { 12, 1, 1 } };
    }
    const struct view_constants constants = { .pixel_per_radian = 1000 };
    double error_px = lod_error_px(
        &(struct lod_params){ .gpu_scene = &gpu_scene, .constants = &constants, .tier = tier, .visible = visible,
                              .visible_count = assets });
    mem_free(visible);
    mem_free(scene.assets);
    mem_free(of_asset);
    return error_px;
}

TEST(pictures_with_room_are_drawn_finer)
{
    assert_float_equal(error_among(3, 1, TIER_REFINED), 0, 0);       /* three assets of 1,000,000 triangles just fit the budget */
    assert_float_equal(error_among(4, 1, TIER_REFINED), 0.35, 1e-9); /* 2 mm */
    assert_float_equal(error_among(10, 1, TIER_REFINED), 0.35, 1e-9);
    assert_float_equal(error_among(11, 1, TIER_REFINED), 0.7, 1e-9);
    assert_float_equal(error_among(1000, 1, TIER_REFINED), 0.7, 1e-9); /* never coarser than shapes allow */
    assert_float_equal(error_among(3, 10, TIER_PREVIEW), 0, 0);
    assert_float_equal(error_among(4, 10, TIER_PREVIEW), 0.25, 1e-9);
    assert_float_equal(error_among(11, 10, TIER_PREVIEW), 0.5, 1e-9);
    assert_float_equal(error_among(31, 10, TIER_PREVIEW), 1, 1e-9);
    assert_float_equal(error_among(1000, 10, TIER_PREVIEW), 1, 1e-9);
    assert_float_equal(error_among(0, 1, TIER_PREVIEW), 0, 0);
}
