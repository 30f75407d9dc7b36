/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Framing: cameras that show a whole target (plant, asset or tag) from a requested side and fill the image with it. */
#include "scene/framing.h"

#include "tests/support/test.h"

#include "scene/extremes.h"
#include "scene/main_part.h"
#include "scene/scene_create.h"
#include "tests/support/small_scene.h"
#include "tests/support/toy.h"

/* Returns the rectangle of the image that the box covers, in coordinates from -1 to 1. */
static struct camera_window taken(const struct camera *camera, double aspect, const double min[3], const double max[3])
{
    struct camera_window out = { INFINITY, -INFINITY, INFINITY, -INFINITY };
    double view[16], projection[16];
    camera_matrices(camera, aspect, min, max, view, projection);
    for (int corner = 0; corner < 8; corner++) {
        double p[3], eye[4] = { 0 }, clip[4] = { 0 };
        for (int i = 0; i < 3; i++)
            p[i] = corner >> i & 1 ? max[i] : min[i];
        for (int row = 0; row < 4; row++)
            eye[row] = view[row] * p[0] + view[4 + row] * p[1] + view[8 + row] * p[2] + view[12 + row];
        for (int row = 0; row < 4; row++)
            for (int c = 0; c < 4; c++)
                clip[row] += projection[4 * c + row] * eye[c];
        assert_true(clip[3] > 0);
        out.left = fmin(out.left, clip[0] / clip[3]);
        out.right = fmax(out.right, clip[0] / clip[3]);
        out.bottom = fmin(out.bottom, clip[1] / clip[3]);
        out.top = fmax(out.top, clip[1] / clip[3]);
    }
    return out;
}

/* Returns the largest absolute image coordinate of the box's corners: 1 means that the box just reaches an edge of the image.
   */
static double reach(const struct camera *camera, double aspect, const double min[3], const double max[3])
{
    struct camera_window box = taken(camera, aspect, min, max);
    return fmax(fmax(-box.left, box.right), fmax(-box.bottom, box.top));
}

static void forward_of(const struct camera *camera, double forward[3])
{
    double length = 0;
    for (int i = 0; i < 3; i++) {
        forward[i] = camera->target_m[i] - camera->eye_m[i];
        length += forward[i] * forward[i];
    }
    for (int i = 0; i < 3; i++)
        forward[i] /= sqrt(length);
}

TEST(every_side_shows_all_of_it)
{
    const struct scene *scene = small_scene();
    for (int asset = -1; asset < 2; asset++)
        for (int side = SIDE_NOW; side <= SIDE_ISO; side++)
            for (int parallel = 0; parallel < 2; parallel++)
                for (double aspect = 0.4; aspect < 3; aspect *= 1.7) {
                    struct camera camera;
                    struct framing framing = { .asset = asset, .tag = -1, .side = (enum side)side };
                    scene_home(scene, aspect, &camera);
                    camera.height_m = parallel;
                    framing_look(scene, &framing, aspect, &camera);
                    assert_true(camera_valid(&camera));
                    assert_int_equal(camera.height_m > 0, parallel);
                    const double *min = asset < 0 ? scene->bounds_min_m : scene->assets[asset].bounds_min_m;
                    const double *max = asset < 0 ? scene->bounds_max_m : scene->assets[asset].bounds_max_m;
                    double most = reach(&camera, aspect, min, max);
                    assert_true(most < 0.96 && most > 0.9);
                }
}

TEST(a_window_is_filled)
{
    static const struct camera_window windows[] = { { -1, 0.6, -1, 0.8 }, { -0.2, 0.9, 0.1, 0.4 }, { -1, -0.5, -1, 1 } };
    const struct scene *scene = small_scene();
    for (int side = SIDE_NOW; side <= SIDE_ISO; side++)
        for (int parallel = 0; parallel < 2; parallel++)
            for (int w = 0; w < 3; w++) {
                const struct camera_window *window = &windows[w];
                struct framing framing = { .asset = 0, .tag = -1, .side = (enum side)side, .window = *window };
                struct camera camera;
                scene_home(scene, 1.6, &camera);
                camera.height_m = parallel;
                framing_look(scene, &framing, 1.6, &camera);
                struct camera_window box = taken(&camera, 1.6, scene->assets[0].bounds_min_m, scene->assets[0].bounds_max_m);
                double wide = (box.right - box.left) / (window->right - window->left);
                double high = (box.top - box.bottom) / (window->top - window->bottom);
                assert_true(box.left > window->left && box.right < window->right);
                assert_true(box.bottom > window->bottom && box.top < window->top);
                assert_true(fmax(wide, high) > 0.9);
            }
}

TEST(sides_are_where_they_should_be)
{
    static const double forward[][3] = { [SIDE_TOP] = { 0, 0, -1 },  [SIDE_BOTTOM] = { 0, 0, 1 }, [SIDE_FRONT] = { 0, 1, 0 },
                                         [SIDE_BACK] = { 0, -1, 0 }, [SIDE_LEFT] = { 1, 0, 0 },   [SIDE_RIGHT] = { -1, 0, 0 } };
    for (int side = SIDE_TOP; side <= SIDE_RIGHT; side++) {
        struct camera camera = { .eye_m = { 9, 9, 9 }, .up = { 0, 0, 1 }, .fov_deg = 45, .height_m = 1 };
        struct framing framing = { .asset = -1, .tag = -1, .side = (enum side)side };
        double got[3];
        framing_look(small_scene(), &framing, 1.5, &camera);
        forward_of(&camera, got);
        for (int i = 0; i < 3; i++)
            assert_float_equal(got[i], forward[side][i], 2e-3);
        assert_true(camera.up[2] == 1);
    }
}

TEST(north_is_above_in_a_plan)
{
    struct camera camera = { .eye_m = { 9, 9, 9 }, .up = { 0, 0, 1 }, .fov_deg = 45 };
    struct framing framing = { .asset = -1, .tag = -1, .side = SIDE_TOP };
    double view[16], projection[16];
    framing_look(small_scene(), &framing, 1.5, &camera);
    camera_matrices(&camera, 1.5, small_scene()->bounds_min_m, small_scene()->bounds_max_m, view, projection);
    assert_float_equal(view[0], 1, 1e-6); /* right is east */
    assert_float_equal(view[5], 1, 1e-5); /* up is north */
}

TEST(names_are_found)
{
    const struct plant *plant = small_scene()->plant;
    struct framing framing;
    assert_true(framing_find(plant, "P-101A", &framing) && framing.asset == 1 && framing.tag == -1);
    assert_true(framing_find(plant, "TI-1", &framing) && framing.asset == -1 && framing.tag == 0);
    assert_true(framing_find(plant, NULL, &framing) && framing.asset == -1 && framing.tag == -1);
    assert_false(framing_find(plant, "XI-1", &framing));
    assert_false(framing_find(plant, "", &framing));
}

TEST(a_sensor_is_seen_from_outside)
{
    const struct scene *scene = small_scene();
    struct camera camera;
    struct framing framing;
    double forward[3];
    scene_home(scene, 1.5, &camera);
    assert_true(framing_find(scene->plant, "TI-1", &framing));
    framing_look(scene, &framing, 1.5, &camera);
    const double *at = scene->assets[0].sensors[0].surface_m;
    for (int i = 0; i < 3; i++)
        assert_float_equal(camera.target_m[i], at[i], 0.3);
    forward_of(&camera, forward);
    assert_true(forward[0] > 0.9 && forward[2] < -0.2); /* the camera looks east and down, from the west end */
    double away = hypot(hypot(camera.eye_m[0] - at[0], camera.eye_m[1] - at[1]), camera.eye_m[2] - at[2]);
    assert_true(away > 1 && away < 8);
}

/* --- the first view ---------------------------------------------------------------------------------------------------------- */

static void add_box(struct toy *toy, const char *id, const double size_m[3], const double at_m[3])
{
    struct test_shape shape = { 0 };
    shape_box(&shape, TOY_STEEL, (double[3]){ 0, 0, 0 }, size_m);
    toy_add(toy, id, &shape, at_m, NULL, 0);
}

/* Asserts that the home view of a plant fills the image with its assets except the strays (objects far from all others), and
   that the number of assets reported as outside is `outside`. */
static void expect_framed(struct toy *toy, int outside)
{
    struct camera camera;
    main_part_find(NULL, &toy->scene);
    extremes_find(&toy->scene);
    assert_int_equal(toy->scene.outside.assets, outside);
    assert_true((toy->scene.outside.triangles > 0) == (outside > 0));
    for (double aspect = 0.5; aspect < 3; aspect *= 1.7) {
        double part = 0;
        scene_home(&toy->scene, aspect, &camera);
        assert_true(camera_valid(&camera));
        for (size_t i = 0; i < toy->scene.asset_count; i++)
            if (!toy->scene.assets[i].stray)
                part = fmax(part, reach(&camera, aspect, toy->scene.assets[i].bounds_min_m, toy->scene.assets[i].bounds_max_m));
        assert_true(part <= 1 && part > 0.9);
    }
    toy_destroy(&toy);
}

TEST(a_stray_piece_is_left_out)
{
    /* side of the stray box in metres; its distance, millions of metres, makes it a stray even if it is as large as the other
       assets */
    static const double sizes[] = { 0.001, 0.1, 1 };
    for (int i = 0; i < 3; i++) {
        struct toy *toy = toy_create();
        double size = sizes[i];
        add_box(toy, "P-101", (double[3]){ 1, 1, 1 }, (double[3]){ 260978, 7007098, 12 });
        add_box(toy, "P-102", (double[3]){ 1, 1, 1 }, (double[3]){ 260980, 7007098, 12 });
        add_box(toy, "STRAY", (double[3]){ size, size, size }, (double[3]){ 0, 0, 0 });
        expect_framed(toy, 1);
    }
}

TEST(a_stray_vertex_is_left_out)
{
    struct toy *toy = toy_create();
    struct test_shape shape = { 0 };
    shape_box(&shape, TOY_STEEL, (double[3]){ 0, 0, 0 }, (double[3]){ 4, 2, 1 });
    shape_plate(&shape, TOY_STEEL, (double[3]){ 1, 1, 0.5 }, (double[3]){ 0.1, 0, 0 }, (double[3]){ 0, 0.1, 0 }, 1);
    shape.positions[shape.vertex_count - 1][0] = -250000;
    toy_add(toy, "A", &shape, (double[3]){ 0, 0, 0 }, NULL, 0);
    struct camera camera;
    main_part_find(NULL, &toy->scene);
    extremes_find(&toy->scene);
    assert_in_range(toy->scene.outside.triangles, 1, 2);
    assert_true(toy->scene.outside.away_m > 249000 && toy->scene.assets[0].stray);
    scene_home(&toy->scene, 1.5, &camera);
    double part = reach(&camera, 1.5, (double[3]){ 0, 0, 0 }, (double[3]){ 4, 2, 1 });
    assert_true(part <= 1 && part > 0.9);
    toy_destroy(&toy);
}

TEST(small_and_long_ones_fill_the_picture)
{
    static const double sizes_m[][3] = { { 1e-3, 1e-3, 1e-3 }, { 5e-3, 2e-3, 1e-3 }, { 0.02, 0.02, 0.02 }, { 0.1, 0.05, 0.02 },
                                         { 300, 0.2, 0.2 },    { 80, 60, 0.01 },     { 0.2, 0.2, 90 } };
    for (size_t i = 0; i < sizeof(sizes_m) / sizeof(*sizes_m); i++) {
        struct toy *toy = toy_create();
        add_box(toy, "A", sizes_m[i], (double[3]){ 0, 0, 0 });
        expect_framed(toy, 0);
    }
}

/* None of these is a stray: a high thin stack beside a plant, units far apart, a large ground plate with little on it. */
TEST(what_belongs_together_stays)
{
    struct toy *toy = toy_create();
    add_box(toy, "PLANT", (double[3]){ 20, 20, 10 }, (double[3]){ 0, 0, 0 });
    add_box(toy, "STACK", (double[3]){ 0.5, 0.5, 60 }, (double[3]){ 30, 10, 0 });
    expect_framed(toy, 0);
    toy = toy_create();
    add_box(toy, "WEST", (double[3]){ 10, 10, 5 }, (double[3]){ 0, 0, 0 });
    add_box(toy, "EAST", (double[3]){ 10, 10, 5 }, (double[3]){ 400, 0, 0 });
    expect_framed(toy, 0);
    toy = toy_create();
    add_box(toy, "PLATE", (double[3]){ 0.18, 0.15, 0.02 }, (double[3]){ 0, 0, 0 });
    add_box(toy, "BRACKET", (double[3]){ 0.05, 0.05, 0.08 }, (double[3]){ 0.06, 0.05, 0.02 });
    expect_framed(toy, 0);
    toy = toy_create(); /* a long pipe with flanges at its ends: the pipe's triangles connect the flanges, so neither counts as a stray */
    add_box(toy, "FLANGE-1", (double[3]){ 0.05, 0.5, 0.5 }, (double[3]){ 0, 0, 0 });
    add_box(toy, "PIPE", (double[3]){ 200, 0.3, 0.3 }, (double[3]){ 0.05, 0.1, 0.1 });
    add_box(toy, "FLANGE-2", (double[3]){ 0.05, 0.5, 0.5 }, (double[3]){ 200.05, 0, 0 });
    expect_framed(toy, 0);
}

/* A stray box 300 m away must not be cut off by the far plane. One 5,000 km away is cut off, because the near plane would
   otherwise have to cut into the plant to keep depth precise. */
TEST(depth_holds_strays_as_far_as_it_resolves_the_plant)
{
    static const double strays_m[] = { 300, 5e6 };
    for (int i = 0; i < 2; i++) {
        struct toy *toy = toy_create();
        double low[3], high[3];
        add_box(toy, "PLANT", (double[3]){ 2, 2, 2 }, (double[3]){ 0, 0, 0 });
        add_box(toy, "STRAY", (double[3]){ 0.1, 0.1, 0.1 }, (double[3]){ strays_m[i], 0, 0 });
        memcpy(toy->scene.whole_min_m, toy->scene.bounds_min_m, sizeof(low));
        memcpy(toy->scene.whole_max_m, toy->scene.bounds_max_m, sizeof(high));
        main_part_find(NULL, &toy->scene);
        assert_int_equal(toy->scene.outside.assets, 1);
        scene_depth_box(&toy->scene, (double[3]){ -5, -5, 3 }, low, high); /* at a medium distance */
        assert_true(i == 0 ? high[0] > 300 : high[0] < 3);
        scene_depth_box(&toy->scene, (double[3]){ -1e3, 0, 1 }, low, high);
        assert_true(high[0] > strays_m[i]);
        toy_destroy(&toy);
    }
}
