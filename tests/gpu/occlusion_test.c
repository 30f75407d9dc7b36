/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Occlusion culling, which skips geometry that nearer geometry hides: hidden geometry is not drawn, and every pixel equals that
   of a frame without culling. Cameras stand outside, among and inside the assets. */
#include "tests/support/test.h"
#include <limits.h>

#include "render/split_view.h"
#include "tests/support/renderer_compare.h"
#include "tests/support/site.h"
#include "tests/support/synthetic.h"

enum { WIDTH_PX = 320, HEIGHT_PX = 180 };
static struct rig rig;
static uint64_t seed;

struct occlusion_tally {
    size_t pictures, left_out, different;
};

/* Draws with or without occlusion culling (leave_out). *count receives the number of culled assets. Culling of clusters seen
   from behind stays on in both cases, because it may lose a pixel of a cluster seen edge-on. */
static struct frame *draw(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot, bool leave_out,
                          size_t *count)
{
    renderer_set_occlusion_least(renderer, leave_out ? 0 : INT_MAX - 1);
    struct frame *frame = split_view_draw_now(renderer, view, snapshot);
    assert_non_null(frame);
    *count = renderer_occluded_count(renderer);
    return frame;
}

static void compare(struct occlusion_tally *tally, struct renderer *renderer, const struct view *view, const struct snapshot *snapshot)
{
    size_t none = 1, some = 0;
    struct frame *all = draw(renderer, view, snapshot, false, &none), *seen = draw(renderer, view, snapshot, true, &some);
    assert_int_equal(none, 0);
    int count = 0;
    for (int y = 0; y < HEIGHT_PX; y++)
        for (int x = 0; x < WIDTH_PX; x++)
            count += memcmp(frame_pixel(all, x, y), frame_pixel(seen, x, y), 4) != 0;
    if (count > 0)
        print_message("picture %zu: %d pixels differ; eye %.3f %.3f %.3f m\n", tally->pictures, count, view->camera.eye_m[0],
                      view->camera.eye_m[1], view->camera.eye_m[2]);
    assert_int_equal(all->marker_count, seen->marker_count);
    for (size_t i = 0; i < all->marker_count; i++)
        assert_int_equal(all->markers[i].occluded, seen->markers[i].occluded);
    tally->pictures++;
    tally->left_out += some;
    tally->different += count > 0;
    frame_unref(&all);
    frame_unref(&seen);
}

static double random_between(double low, double high)
{
    return low + (high - low) * synthetic_random_unit(&seed);
}

/* Chooses a random camera inside an asset's box, near it or far away; sometimes orthographic, clipped, with ghosts, or with
   hidden assets. */
static void look_anyhow(const struct scene *scene, struct view *view)
{
    const struct scene_asset *asset = &scene->assets[synthetic_random(&seed) % scene->asset_count];
    double away = (double[]){ 0, 0.5, 1, 5 }[synthetic_random(&seed) % 4], middle[3], far[3];
    view_default(scene, WIDTH_PX, HEIGHT_PX, view);
    view->tier = synthetic_random(&seed) % 3 ? TIER_PREVIEW : TIER_REFINED;
    for (int c = 0; c < 3; c++) {
        double size = asset->bounds_max_m[c] - asset->bounds_min_m[c] + 0.2;
        middle[c] = scene->bounds_min_m[c] + random_between(0.2, 0.8) * (scene->bounds_max_m[c] - scene->bounds_min_m[c]);
        view->camera.eye_m[c] = random_between(asset->bounds_min_m[c] - away * size, asset->bounds_max_m[c] + away * size);
        view->camera.target_m[c] = away < 5 ? view->camera.eye_m[c] + random_between(-1, 1) : middle[c];
        far[c] = random_between(middle[c], scene->bounds_max_m[c] + 1);
    }
    view->camera.fov_deg = random_between(20, 90);
    if (synthetic_random(&seed) % 4 == 0)
        view->camera.height_m = random_between(1, 30);
    if (synthetic_random(&seed) % 4 == 0)
        clip_box(&view->visibility.clip, scene->bounds_min_m, far);
    if (synthetic_random(&seed) % 4 == 0)
        asset_set_add(&view->visibility.ghosts, (int)(asset - scene->assets));
    if (synthetic_random(&seed) % 4 == 0)
        asset_set_add(&view->visibility.hidden, (int)(synthetic_random(&seed) % scene->asset_count));
    if (synthetic_random(&seed) % 4 == 0)
        view->look = LOOK_MATERIALS;
}

static void finish(const char *what, const struct occlusion_tally *tally, size_t least)
{
    print_message("# %s: %zu pictures, %zu times an asset was left out, %zu pictures differ\n", what, tally->pictures, tally->left_out,
                  tally->different);
    assert_int_equal(tally->different, 0);
    assert_true(tally->left_out >= least);
}

TEST(test_the_demo_plant)
{
    const size_t least = (size_t)sweep(4, 1);
    struct site site;
    struct occlusion_tally tally = { 0 };
    assert_true(site_init(&site, &rig, SITE_DEMO, NULL));
    renderer_use_gl(site.renderer, true);
    for (int i = 0; i < 40 && (i < sweep(40, 2) || tally.left_out < least); i++) {
        struct view view;
        look_anyhow(site.scene, &view);
        compare(&tally, site.renderer, &view, site.snapshot);
    }
    finish("demo", &tally, least);
    site_finish(&site);
}

/* --- a block of ROW x ROW x ROW cubes with small gaps; each cube is an asset that fills its bounding box
   ----------------------------- */

/* ROW: number of cubes along each side of the block; SIDE: number of squares along each edge of a cube's face */
enum { ROW = 3, SIDE = 6 };

static void add_cube(struct toy *toy, const char *id, const double at[3])
{
    struct test_shape shape = { 0 };
    for (int face = 0; face < 6; face++) {
        double corner[3] = { 0 }, u[3] = { 0 }, v[3] = { 0 };
        int axis = face / 2, far = face % 2; /* u, v: edges of the face, in an order in which u x v points out of the cube */
        corner[axis] = far;
        u[(axis + (far ? 1 : 2)) % 3] = 1;
        v[(axis + (far ? 2 : 1)) % 3] = 1;
        shape_plate(&shape, TOY_STEEL, corner, u, v, SIDE);
    }
    toy_add(toy, id, &shape, at, NULL, 0);
}

static struct toy *make_city(double gap_m)
{
    struct toy *toy = toy_create();
    for (int i = 0; i < ROW * ROW * ROW; i++) {
        char *id = test_printf("cube-%d", i);
        add_cube(toy, id, (double[3]){ (1 + gap_m) * (i % ROW), (1 + gap_m) * (i / ROW % ROW), (1 + gap_m) * (i / ROW / ROW) });
    }
    return toy;
}

TEST(test_cubes)
{
    for (int i = 0; i < 3; i++) {
        struct stand stand;
        struct occlusion_tally tally = { 0 };
        double gap_m = (double[]){ 0, 0.02, 0.3 }[i];
        stand_init(&stand, &rig, make_city(gap_m));
        renderer_use_gl(stand.renderer, true);
        for (int k = 0; k < sweep(25, 2); k++) {
            struct view view;
            look_anyhow(&stand.toy->scene, &view);
            compare(&tally, stand.renderer, &view, stand.snapshot);
        }
        finish(test_printf("cubes %g m apart", gap_m), &tally, tally.pictures);
        stand_finish(&stand);
    }
}

/* The camera looks at the middle of one side of the block. Only the ROW x ROW cubes of that side may be drawn; all others are
   hidden. */
TEST(test_a_wall_hides_what_is_behind)
{
    struct stand stand;
    struct view view;
    size_t count = 0;
    stand_init(&stand, &rig, make_city(0.02));
    renderer_use_gl(stand.renderer, true);
    view_default(&stand.toy->scene, WIDTH_PX, HEIGHT_PX, &view);
    view.tier = TIER_PREVIEW;
    /* the picture is large enough for the renderer's margin around boxes to be narrower than the gaps between the cubes */
    view.width_px = 1280;
    view.height_px = 720;
    double middle_m = 0.5 * (ROW + 0.02 * (ROW - 1));
    view.camera =
        (struct camera){ .eye_m = { -9, middle_m, middle_m }, .target_m = { 0, middle_m, middle_m }, .up = { 0, 0, 1 }, .fov_deg = 40 };
    struct frame *frame = draw(stand.renderer, &view, stand.snapshot, true, &count);
    frame_unref(&frame);
    print_message("# a wall: %zu of %d cubes left out\n", count, ROW * ROW * ROW);
    assert_int_equal(count, (ROW - 1) * ROW * ROW);
    /* The section box removes the front layer of cubes, so the second layer hides the rest. */
    clip_box(&view.visibility.clip, (double[3]){ 1.1, -1, -1 }, (double[3]){ 9, 9, 9 });
    frame = draw(stand.renderer, &view, stand.snapshot, true, &count);
    frame_unref(&frame);
    assert_int_equal(count, (ROW - 2) * ROW * ROW);
    stand_finish(&stand);
}

/* One asset consists of three balls, two of them far away on opposite sides, so that the eye is inside the asset's box. A wall
   fills the picture and hides most of the box, but the third ball is in front of the wall and must be drawn. */
TEST(test_the_eye_in_a_box)
{
    struct toy *toy = toy_create();
    struct test_shape wall = { 0 }, balls = { 0 };
    struct stand stand;
    struct view view;
    struct occlusion_tally tally = { 0 };
    shape_plate(&wall, TOY_BLUE, (double[3]){ -4, 3, -4 }, (double[3]){ 8, 0, 0 }, (double[3]){ 0, 0, 8 }, 20);
    shape_sphere(&balls, TOY_STEEL, (double[3]){ 0, 2, 0 }, 0.3, 6);
    shape_sphere(&balls, TOY_STEEL, (double[3]){ 9, -9, 9 }, 0.3, 6);
    shape_sphere(&balls, TOY_STEEL, (double[3]){ -9, 9, -9 }, 0.3, 6);
    toy_add(toy, "wall", &wall, (double[3]){ 0 }, NULL, 0);
    toy_add(toy, "balls", &balls, (double[3]){ 0 }, NULL, 0);
    stand_init(&stand, &rig, toy);
    renderer_use_gl(stand.renderer, true);
    view_default(&toy->scene, WIDTH_PX, HEIGHT_PX, &view);
    for (int parallel = 0; parallel < 2; parallel++) {
        view.camera = (struct camera){ .target_m = { 0, 1, 0 }, .up = { 0, 0, 1 }, .fov_deg = 40, .height_m = parallel ? 2 : 0 };
        compare(&tally, stand.renderer, &view, stand.snapshot);
    }
    stand_finish(&stand);
    finish("a ball before a wall", &tally, 0);
}

int main(void)
{
    const char *given = getenv("PLANTCAST_SEED");
    seed = given ? strtoull(given, NULL, 10) : 4;
    print_message("# PLANTCAST_SEED=%llu\n", (unsigned long long)seed);
    return rig_run(&rig);
}
