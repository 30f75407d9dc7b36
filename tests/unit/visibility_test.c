/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Visibility of assets: shown, ghosted, hidden and clipped, and the client messages that set this. */
#include "message/visibility.h"

#include "tests/support/test.h"

#include "render/view.h"
#include "tests/support/small_scene.h"

TEST(looks_of_assets)
{
    struct visibility v = { 0 };
    assert_int_equal(visibility_of(&v, 0), ASSET_SHOWN);
    assert_int_equal(visibility_of(&v, ASSET_SET_MAX + 5), ASSET_SHOWN);
    asset_set_add(&v.isolated, 65);
    assert_int_equal(visibility_of(&v, 65), ASSET_SHOWN);
    assert_int_equal(visibility_of(&v, 1), ASSET_HIDDEN);
    assert_int_equal(visibility_of(&v, ASSET_SET_MAX + 5), ASSET_HIDDEN);
    asset_set_add(&v.ghosts, 1);
    assert_int_equal(visibility_of(&v, 1), ASSET_GHOST);
    asset_set_add(&v.hidden, 1);
    asset_set_add(&v.hidden, 65);
    assert_int_equal(visibility_of(&v, 1), ASSET_HIDDEN);
    assert_int_equal(visibility_of(&v, 65), ASSET_HIDDEN);
    asset_set_add(&v.hidden, 65);
    assert_int_equal(v.hidden.count, 2);
}

TEST(equal_views_are_equal)
{
    struct visibility a = { 0 }, b = { 0 };
    assert_true(visibility_equal(&a, &b));
    asset_set_add(&a.ghosts, 4000);
    assert_false(visibility_equal(&a, &b));
    asset_set_add(&b.ghosts, 4000);
    assert_true(visibility_equal(&a, &b));
    clip_box(&a.clip, (double[3]){ 0, 0, 0 }, (double[3]){ 1, 2, 3 });
    assert_false(visibility_equal(&a, &b));
    clip_box(&b.clip, (double[3]){ 0, 0, 0 }, (double[3]){ 1, 2, 3 });
    assert_true(visibility_equal(&a, &b));
    b.clip.planes[3][3] = 2.5;
    assert_false(visibility_equal(&a, &b));
}

TEST(a_box_keeps_what_is_in_it)
{
    struct clip clip;
    double min[3], max[3];
    clip_box(&clip, (double[3]){ -1, -2, -3 }, (double[3]){ 1, 2, 3 });
    clip_get_box(&clip, min, max);
    assert_true(min[0] == -1 && min[2] == -3 && max[1] == 2 && max[2] == 3);
    assert_true(clip_keeps(&clip, (double[3]){ 0.9, -1.9, 2.9 }));
    assert_false(clip_keeps(&clip, (double[3]){ 1.1, 0, 0 }));
    assert_false(clip_keeps(&clip, (double[3]){ 0, 0, -3.1 }));
}

/* Random rays and section planes: a point of a ray is within the ray's visible part exactly if no plane cuts it away. */
TEST(rays_are_cut_where_planes_are)
{
    srand(3);
    int kept = 0;
    for (int round = 0; round < 20000; round++) {
        struct clip clip = { .plane_count = 1 + rand() % CLIP_MAX_PLANES };
        double origin[3], direction[3], low = 0, high = 10;
        for (int i = 0; i < 3; i++) {
            origin[i] = rand() * 4.0 / RAND_MAX - 2;
            direction[i] = rand() % 5 ? rand() * 2.0 / RAND_MAX - 1 : 0;
        }
        for (int p = 0; p < clip.plane_count; p++)
            for (int i = 0; i < 4; i++)
                clip.planes[p][i] = rand() * 2.0 / RAND_MAX - 1;
        bool any = clip_ray(&clip, origin, direction, &low, &high);
        for (double t = 0.013; t < 10; t += 0.37) {
            double at[3];
            for (int i = 0; i < 3; i++)
                at[i] = origin[i] + t * direction[i];
            if (any && (fabs(t - low) < 1e-6 || fabs(t - high) < 1e-6))
                continue;
            assert_int_equal(clip_keeps(&clip, at), any && t >= low && t <= high);
            kept += clip_keeps(&clip, at);
        }
    }
    assert_true(kept > 10000);
}

static struct params_change parse(const char *text)
{
    struct params_change change = { 0 };
    struct message_error error = { 0 };
    json_t *o = test_json(json_loads(text, 0, NULL));
    if (!visibility_parse(small_scene()->plant, o, &change, &error))
        fail_msg("%s: %s", text, error.text);
    return change;
}

static void assert_printed(const struct visibility *visibility, const char *text)
{
    json_t *got = test_json(json_object()), *want = test_json(json_loads(text, 0, NULL));
    visibility_print(small_scene()->plant, visibility, got);
    if (!json_equal(got, want))
        fail_msg("%s", json_dumps(got, JSON_COMPACT));
}

TEST(what_is_said_comes_back)
{
    struct visibility v = { 0 };
    assert_printed(&v, "{\"hidden\":[],\"isolate\":[],\"ghost\":[],\"clip\":null}");
    struct params_change change = parse("{\"hidden\":[\"P-101A\"],\"clip\":{\"planes\":[[0,-2,0,1]]}}");
    visibility_apply(&change, &v);
    assert_printed(&v, "{\"hidden\":[\"P-101A\"],\"isolate\":[],\"ghost\":[],\"clip\":{\"planes\":[[0.0,-1.0,0.0,0.5]]}}");
    change = parse("{\"ghost\":[\"E-101\",\"P-101A\"],\"clip\":{\"box\":{\"min\":[-1,-2,0],\"max\":[1,2,3]}}}");
    visibility_apply(&change, &v);
    assert_printed(&v, "{\"hidden\":[\"P-101A\"],\"isolate\":[],\"ghost\":[\"E-101\",\"P-101A\"],"
                       "\"clip\":{\"box\":{\"min\":[-1.0,-2.0,-0.0],\"max\":[1.0,2.0,3.0]}}}");
    change = parse("{\"hidden\":[],\"ghost\":[],\"isolate\":[\"E-101\"],\"clip\":null}");
    visibility_apply(&change, &v);
    assert_printed(&v, "{\"hidden\":[],\"isolate\":[\"E-101\"],\"ghost\":[],\"clip\":null}");
    struct params_change nothing = parse("{}");
    assert_int_equal(nothing.given, 0);
}

TEST(assets_start_as_the_plant_says)
{
    struct plant_asset *assets = small_scene()->plant->assets;
    struct view view;
    assets[0].start = PLANT_START_GHOST;
    assets[1].start = PLANT_START_HIDDEN;
    view_default(small_scene(), 640, 360, &view);
    assets[0].start = assets[1].start = PLANT_START_SHOWN;
    assert_printed(&view.visibility, "{\"hidden\":[\"P-101A\"],\"isolate\":[],\"ghost\":[\"E-101\"],\"clip\":null}");
    struct params_change change = parse("{\"hidden\":[]}"); /* none is said */
    visibility_apply(&change, &view.visibility);
    assert_printed(&view.visibility, "{\"hidden\":[],\"isolate\":[],\"ghost\":[\"E-101\"],\"clip\":null}");
    change = parse("{\"ghost\":[]}");
    visibility_apply(&change, &view.visibility);
    assert_true(visibility_equal(&view.visibility, &(struct visibility){ 0 }));
}
