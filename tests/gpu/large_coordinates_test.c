/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws the same plant at the origin and at survey coordinates (UTM, 5,500 km north of the origin): both must look the same. */
#include "tests/support/test.h"

#include "render/pick/pick.h"
#include "tests/support/rig.h"

enum { WIDTH_PX = 320, HEIGHT_PX = 240, PIXELS = WIDTH_PX * HEIGHT_PX };

static const double FAR_OFF_M[3] = { 412345, 5512345, 120 };
/* positions may differ by this many metres between the two plants; a double at 5.5e6 m resolves 1e-9 m */
static const double SAME_M = 1e-6;

static struct rig rig;
static struct stand near, far;

static void move(double place_m[3], const double by_m[3])
{
    for (int c = 0; c < 3; c++)
        place_m[c] += by_m[c];
}

static void move_scene(struct scene *scene, const double by_m[3])
{
    move(scene->bounds_min_m, by_m);
    move(scene->bounds_max_m, by_m);
    for (size_t i = 0; i < scene->asset_count; i++) {
        struct scene_asset *asset = &scene->assets[i];
        move(&asset->placement[12], by_m);
        move(asset->bounds_min_m, by_m);
        move(asset->bounds_max_m, by_m);
        for (size_t s = 0; s < asset->sensor_count; s++) {
            move(asset->sensors[s].position_m, by_m);
            move(asset->sensors[s].surface_m, by_m);
        }
    }
}

/* Makes the i-th view of the plant at the origin, and the same view of the distant plant. */
static void look(int i, struct view *at_near, struct view *at_far)
{
    view_default(&near.toy->scene, WIDTH_PX, HEIGHT_PX, at_near);
    view_default(&far.toy->scene, WIDTH_PX, HEIGHT_PX, at_far);
    for (int c = 0; i < 0 && c < 3; c++)
        assert_float_equal(at_far->camera.eye_m[c], at_near->camera.eye_m[c] + FAR_OFF_M[c], SAME_M);
    if (i < 0)
        return;
    stand_look(&near, i, at_near);
    at_far->camera = at_near->camera;
    move(at_far->camera.eye_m, FAR_OFF_M);
    move(at_far->camera.target_m, FAR_OFF_M);
}

/* Asserts that the frames of both plants are equal. A few pixels may differ, namely those whose centre lies exactly on an edge.
   */
static void assert_same(const struct view *at_near, const struct view *at_far)
{
    struct frame *a = stand_draw(&near, at_near), *b = stand_draw(&far, at_far);
    int differ = 0;
    for (int i = 0; i < PIXELS; i++) {
        int most = 0;
        for (int c = 0; c < 3; c++) {
            int by = abs(a->bgrx[4 * i + c] - b->bgrx[4 * i + c]);
            most = by > most ? by : most;
        }
        differ += most > 3;
    }
    if (differ > PIXELS / 1000)
        print_message("# %d of %d pixels differ\n", differ, PIXELS);
    assert_true(differ <= PIXELS / 1000);
    assert_true(a->marker_count == b->marker_count && a->marker_count > 0);
    for (size_t i = 0; i < a->marker_count; i++) {
        assert_int_equal(a->markers[i].tag, b->markers[i].tag);
        assert_int_equal(a->markers[i].occluded, b->markers[i].occluded);
        assert_float_equal(a->markers[i].x_px, b->markers[i].x_px, 1e-3);
        assert_float_equal(a->markers[i].y_px, b->markers[i].y_px, 1e-3);
    }
    frame_unref(&a);
    frame_unref(&b);
}

static void assert_same_cameras(bool by_gl, enum tier tier)
{
    renderer_use_gl(near.renderer, by_gl);
    renderer_use_gl(far.renderer, by_gl);
    for (int i = -1; i < 8; i++) {
        struct view at_near, at_far;
        look(i, &at_near, &at_far);
        at_near.tier = at_far.tier = tier;
        assert_same(&at_near, &at_far);
    }
}

TEST(test_moving_without_a_gpu)
{
    assert_same_cameras(false, TIER_PREVIEW);
}

TEST(test_still_without_a_gpu)
{
    assert_same_cameras(false, TIER_REFINED);
}

TEST(test_moving_by_gl)
{
    assert_same_cameras(true, TIER_PREVIEW);
}

TEST(test_still_by_gl)
{
    assert_same_cameras(true, TIER_REFINED);
}

TEST(test_orthographic_and_cut)
{
    struct view at_near, at_far;
    for (int by_gl = 0; by_gl < 2; by_gl++) {
        renderer_use_gl(near.renderer, by_gl);
        renderer_use_gl(far.renderer, by_gl);
        look(0, &at_near, &at_far);
        at_near.tier = at_far.tier = TIER_REFINED;
        at_near.camera.height_m = at_far.camera.height_m = 6;
        assert_same(&at_near, &at_far);
        at_near.visibility.clip = (struct clip){ .plane_count = 1, .planes = { { 1, 0, 0, 0.3 } } }; /* keeps only x >= -0.3 */
        at_far.visibility.clip = (struct clip){ .plane_count = 1, .planes = { { 1, 0, 0, 0.3 - FAR_OFF_M[0] } } };
        assert_same(&at_near, &at_far);
    }
}

TEST(test_places_and_distances)
{
    int hits = 0, sensors = 0;
    for (int i = -1; i < 4; i++) {
        struct view at_near, at_far;
        look(i, &at_near, &at_far);
        for (int p = 0; p < 100; p++) {
            struct pick a, b;
            double x = (p % 10 + 0.37) * WIDTH_PX / 10, y = (p / 10 + 0.61) * HEIGHT_PX / 10;
            pick_at(&near.toy->scene, near.field, &at_near, near.snapshot, x, y, &a);
            pick_at(&far.toy->scene, far.field, &at_far, far.snapshot, x, y, &b);
            assert_int_equal(a.asset, b.asset);
            assert_int_equal(a.sensor, b.sensor);
            if (a.asset < 0)
                continue;
            hits++;
            assert_true(a.state == b.state && a.nearest_count == b.nearest_count);
            for (int c = 0; c < 3; c++)
                assert_float_equal(a.position_m[c] + FAR_OFF_M[c], b.position_m[c], SAME_M);
            for (int s = 0; s < a.nearest_count; s++, sensors++)
                assert_float_equal(a.nearest[s].distance_m, b.nearest[s].distance_m, SAME_M);
        }
    }
    assert_true(hits > 50 && sensors > 50);
}

int main(void)
{
    if (!rig_init(&rig, "large_coordinates_test"))
        return 0;
    struct toy *toy = toy_unit();
    move_scene(&toy->scene, FAR_OFF_M);
    stand_init(&near, &rig, toy_unit());
    stand_init(&far, &rig, toy);
    toy_fill(near.snapshot, 0);
    toy_fill(far.snapshot, 0);
    int failed = tests_run(NULL);
    stand_finish(&near);
    stand_finish(&far);
    rig_finish(&rig);
    return failed;
}
