/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draw batches: assets that share a model are drawn by one call. The picture equals drawing each by itself, and more assets
   need no more calls. */
#include "tests/support/test.h"
#include <limits.h>

#include "tests/support/gl_calls.h"
#include "tests/support/no_textures.h"
#include "tests/support/planned.h"
#include "tests/support/renderer_compare.h"
#include "tests/support/rig.h"
#include "tests/support/synthetic.h"
#include "value/quality.h"

enum { WIDTH_PX = 320, HEIGHT_PX = 180, TEXELS_PX = 8, PICTURES = 12 };
/* fraction of a refined frame's pixels that may differ: at silhouettes the drawing order decides where a texture is sampled */
static const double RIM_PART = 0.01;
static struct rig rig;
static uint64_t seed;
static struct asset_material materials[4];
static struct asset_texture texture = { .width_px = TEXELS_PX, .height_px = TEXELS_PX, .srgb = 1, .wrap_repeat = 1 };
static uint8_t texels[TEXELS_PX * TEXELS_PX][4];
static float texcoords[4096][2];

static double random_between(double low, double high)
{
    return low + (high - low) * synthetic_random_unit(&seed);
}

static bool one_in(uint64_t n)
{
    return synthetic_random(&seed) % n == 0;
}

/* Makes materials: plain steel, one with a texture, one whose texture cuts holes, and glass. */
static void make_materials(void)
{
    for (int i = 0; i < TEXELS_PX * TEXELS_PX; i++)
        memcpy(texels[i], (uint8_t[4]){ (uint8_t)(i * 37), (uint8_t)(i * 71), 90, i % 3 ? 255 : 0 }, 4);
    for (int i = 0; i < 4096; i++)
        for (int c = 0; c < 2; c++)
            texcoords[i][c] = (float)(i * (c ? 29 : 17) % 64) / 32;
    for (int i = 0; i < 4; i++) {
        struct asset_material *it = &materials[i];
        *it = (struct asset_material){ .base_color = { 0.2f + 0.2f * (float)i, 0.5f, 0.4f, 1 }, .roughness = 0.4f, NO_TEXTURES };
        it->normal_scale = it->occlusion_strength = 1;
        if (i == 1 || i == 2)
            it->base_color_texture = 0;
    }
    materials[1].double_sided = 1;
    materials[2].alpha = ASSET_ALPHA_MASK;
    materials[2].alpha_cutoff = 0.5f;
    materials[3].alpha = ASSET_ALPHA_BLEND;
    materials[3].base_color[3] = 0.4f;
}

static void wear(struct test_shape *shape)
{
    *shape =
        (struct test_shape){ .materials = materials, .textures = &texture, .texels = texels[0], .material_count = 4, .texture_count = 1 };
    shape->texcoords = (const float(*)[2])texcoords;
    shape->texel_bytes = sizeof(texels);
}

/* Makes a random placement: rotated about the vertical, scaled, sometimes mirrored. */
static void place_anyhow(double placement[16])
{
    double angle = random_between(0, 2 * M_PI), size = random_between(0.4, 1.6);
    double c = size * cos(angle), s = size * sin(angle), mirror = one_in(3) ? -1 : 1;
    double m[16] = { c, s, 0, 0, -s * mirror, c * mirror, 0, 0, 0, 0, size, 0, 0, 0, 0, 1 };
    for (int i = 0; i < 3; i++)
        m[12 + i] = random_between(-4, 4);
    memcpy(placement, m, sizeof(m));
}

/* Makes a scene of three models, the first two with sensors, and `more` instances of each. */
static struct toy *make_crowd(int more)
{
    static const double sensors[2][3] = { { 0.5, 0, 0 }, { -0.5, 0, 0.2 } };
    struct toy *toy = toy_create();
    struct test_shape shape;
    char id[24];
    wear(&shape);
    shape_sphere(&shape, 0, (double[3]){ 0, 0, 0 }, 0.5, 7);
    shape_box(&shape, 2, (double[3]){ -0.9, -0.1, -0.1 }, (double[3]){ 0.9, 0.1, 0.1 });
    toy_add(toy, "BALL", &shape, (double[3]){ 0, 0, 0 }, sensors, 2);
    wear(&shape);
    shape_cylinder(&shape, 1, (double[3]){ 0, 0, -0.6 }, (double[3]){ 0, 0, 0.6 }, 0.4, 0.3, 0);
    toy_add(toy, "DRUM", &shape, (double[3]){ 1.5, 0, 0 }, sensors, 2);
    wear(&shape);
    shape_box(&shape, 1, (double[3]){ -0.4, -0.4, -0.4 }, (double[3]){ 0.1, 0.4, 0.4 });
    shape_sphere(&shape, 2, (double[3]){ 0.3, 0, 0.3 }, 0.3, 6);
    shape_box(&shape, 3, (double[3]){ -0.5, -0.5, 0.4 }, (double[3]){ 0.5, 0.5, 0.6 });
    toy_add(toy, "CRATE", &shape, (double[3]){ 0, 1.5, 0 }, NULL, 0);
    for (int i = 0; i < more; i++) {
        double placement[16];
        place_anyhow(placement);
        snprintf(id, sizeof(id), "MORE-%d", i);
        toy_add_again(toy, id, i % 3, placement);
    }
    return toy;
}

static void read_anyhow(const struct stand *stand)
{
    for (size_t i = 0; i < stand->toy->plant.tag_count; i++)
        toy_set(stand->snapshot, (int)i, random_between(0, 100), one_in(8) ? QUALITY_BAD_SENSOR_FAILURE : QUALITY_GOOD);
}

static void read_all(const struct stand *stand, double value)
{
    for (size_t i = 0; i < stand->toy->plant.tag_count; i++)
        toy_set(stand->snapshot, (int)i, value, QUALITY_GOOD);
}

static void look_anyhow(const struct scene *scene, struct view *view)
{
    struct view right;
    view_default(scene, WIDTH_PX, HEIGHT_PX, view);
    view->tier = one_in(2) ? TIER_PREVIEW : TIER_REFINED;
    for (int c = 0; c < 3; c++) {
        view->camera.eye_m[c] = random_between(-12, 12);
        view->camera.target_m[c] = random_between(-1, 1);
    }
    view->camera.fov_deg = random_between(25, 80);
    if (one_in(4))
        view->camera.height_m = random_between(4, 12);
    if (one_in(3))
        clip_box(&view->visibility.clip, (double[3]){ -9, -9, -9 },
                 (double[3]){ random_between(-1, 6), random_between(-1, 6), random_between(-1, 6) });
    for (int i = 0; i < 3 && one_in(2); i++) {
        asset_set_add(&view->visibility.ghosts, (int)(synthetic_random(&seed) % scene->asset_count));
        asset_set_add(&view->visibility.hidden, (int)(synthetic_random(&seed) % scene->asset_count));
    }
    view->look = (enum look[]){ LOOK_DEFAULT, LOOK_FLAT, LOOK_GLOSSY, LOOK_MATERIALS }[synthetic_random(&seed) % 4];
    if (one_in(3))
        view->color_scale.log = true;
    right = *view;
    right.look = LOOK_GLOSSY;
    right.field.power = 3;
    if (one_in(4))
        view_split(view, &right);
}

static struct frame *draw(const struct stand *stand, const struct view *view, bool one_by_one)
{
    renderer_set_batching_off(stand->renderer, one_by_one);
    struct frame *frame = split_view_draw_now(stand->renderer, view, stand->snapshot);
    assert_non_null(frame);
    renderer_set_batching_off(stand->renderer, false);
    return frame;
}

static int count_different(const struct frame *a, const struct frame *b)
{
    int count = 0;
    for (int y = 0; y < a->height_px; y++)
        for (int x = 0; x < a->width_px; x++)
            count += memcmp(frame_pixel(a, x, y), frame_pixel(b, x, y), 4) != 0;
    return count;
}

/* Batched drawing must give the same pictures as drawing asset by asset: with culling of clusters, without it, and with
   occlusion culling. */
TEST(test_together_as_one_by_one)
{
    for (int way = 0; way < 3; way++) {
        struct stand stand;
        size_t different = 0;
        int most = 0;
        stand_init(&stand, &rig, make_crowd(24));
        renderer_use_gl(stand.renderer, true);
        for (int i = 0; i < sweep(PICTURES, PICTURES / 6); i++) {
            struct view view;
            read_anyhow(&stand);
            look_anyhow(&stand.toy->scene, &view);
            renderer_set_occlusion_least(stand.renderer, way == 0 ? INT_MAX : INT_MAX - 1);
            struct frame *want = draw(&stand, &view, true);
            if (way == 2)
                renderer_set_occlusion_least(stand.renderer, 0);
            struct frame *got = draw(&stand, &view, false);
            int count = count_different(want, got);
            bool good = view.tier == TIER_PREVIEW ? count == 0 : count <= RIM_PART * WIDTH_PX * HEIGHT_PX;
            most = count > most ? count : most;
            if (!good)
                print_message("way %d, picture %d: %d pixels differ\n", way, i, count);
            different += !good;
            frame_unref(&want);
            frame_unref(&got);
        }
        stand_finish(&stand);
        print_message("# way %d: at most %d pixels of a picture differ\n", way, most);
        assert_int_equal(different, 0);
    }
}

/* Readings that arrive while a frame is drawn in steps must not show in it, although the buffer on the GPU that holds its
   readings is also used for the new ones. */
TEST(test_a_picture_under_way_keeps_its_readings)
{
    struct stand stand;
    struct view view;
    stand_init(&stand, &rig, make_crowd(9));
    renderer_use_gl(stand.renderer, true);
    view_default(&stand.toy->scene, WIDTH_PX, HEIGHT_PX, &view);
    view.tier = TIER_REFINED;
    read_all(&stand, 10);
    struct frame *want = test_frame(stand_draw(&stand, &view));
    struct render_job *job = planned_begin(stand.renderer, &view, stand.snapshot);
    assert_non_null(job);
    renderer_step(stand.renderer, job, 1);
    for (int i = 0; i < 3; i++) {
        read_all(&stand, 90 - i);
        struct frame *other = stand_draw(&stand, &view);
        assert_true(count_different(want, other) > RIM_PART * WIDTH_PX * HEIGHT_PX);
        frame_unref(&other);
    }
    struct frame *got = test_frame(renderer_end(stand.renderer, &job));
    assert_true(count_different(want, got) <= RIM_PART * WIDTH_PX * HEIGHT_PX / 4);
    stand_finish(&stand);
}

/* Sets up a plant of balls in a row, all in view. */
static void stand_row(struct stand *stand, int assets)
{
    static const double sensor[1][3] = { { 0.5, 0, 0 } };
    struct toy *toy = toy_create();
    struct test_shape shape = { 0 };
    shape_sphere(&shape, TOY_STEEL, (double[3]){ 0, 0, 0 }, 0.5, 9);
    shape_box(&shape, TOY_BLUE, (double[3]){ -0.6, -0.1, -0.1 }, (double[3]){ 0.6, 0.1, 0.1 });
    toy_add(toy, "BALL", &shape, (double[3]){ 0, 0, 0 }, sensor, 1);
    for (int i = 1; i < assets; i++) {
        double placement[16] = { [0] = 1, [5] = 1, [10] = 1, [12] = 1.4 * (i % 10), [13] = 1.4 * (i / 10), [15] = 1 };
        toy_add_again(toy, test_printf("BALL-%d", i), 0, placement);
    }
    stand_init(stand, &rig, toy);
    renderer_use_gl(stand->renderer, true);
}

struct calls {
    uint64_t all, draws;
};

/* Draws the same view twice. Returns the number of GL calls for the second frame. changes: all readings change between the
   frames; otherwise the frames are identical, so caches serve the second one. */
static struct calls count_calls(struct stand *stand, enum tier tier, int least, bool changes)
{
    struct view view;
    struct calls calls = { 0 };
    view_default(&stand->toy->scene, WIDTH_PX, HEIGHT_PX, &view);
    view.tier = tier;
    renderer_set_occlusion_least(stand->renderer, least);
    for (int i = 0; i < 2; i++) {
        if (changes || i == 0)
            read_anyhow(stand);
        uint64_t before = gl_calls(), draws_before = gl_draw_calls();
        struct frame *frame = stand_draw(stand, &view);
        calls = (struct calls){ gl_calls() - before, gl_draw_calls() - draws_before };
        frame_unref(&frame);
    }
    return calls;
}

/* Many assets that share a model need no more GL calls than a few, except one upload per asset whose readings have changed. */
TEST(test_more_assets_are_no_more_calls)
{
    enum { FEW = 12, MANY = 60, ROUNDS = 4, ROUND_CALLS = 24, ROUND_DRAWS = 3 };
    struct stand small, large;
    if (!gl_calls_begin(rig.gl))
        skip();
    stand_row(&small, FEW);
    stand_row(&large, MANY);
    for (int way = 0; way < 6; way++) {
        enum tier tier = way % 2 ? TIER_REFINED : TIER_PREVIEW;
        int least = way < 2 ? INT_MAX : way < 4 ? INT_MAX - 1 : 0;
        struct calls few = count_calls(&small, tier, least, false), many = count_calls(&large, tier, least, false);
        struct calls changed = count_calls(&large, tier, least, true);
        print_message("# %s%s: %d assets %d calls, %d draws; %d assets %d and %d; all readings changed %d and %d\n",
                      tier == TIER_REFINED ? "still" : "moving", least == 0 ? ", what is hidden left out" : "", FEW, (int)few.all,
                      (int)few.draws, MANY, (int)many.all, (int)many.draws, (int)changed.all, (int)changed.draws);
        assert_true(few.all > 10 && few.draws > 0);
        if (least > 0)
            assert_true(many.all == few.all && many.draws == few.draws);
        else
            assert_true(many.all <= few.all + ROUNDS * ROUND_CALLS && many.draws <= few.draws + ROUNDS * ROUND_DRAWS);
        assert_true(changed.all <= many.all + MANY && changed.draws == many.draws);
    }
    stand_finish(&small);
    stand_finish(&large);
}

int main(void)
{
    const char *given = getenv("PLANTCAST_SEED");
    seed = given ? strtoull(given, NULL, 10) : 4;
    if (!rig_init(&rig, "draw_batches_test"))
        return 0;
    make_materials();
    print_message("# PLANTCAST_SEED=%llu\n", (unsigned long long)seed);
    int failed = tests_run(NULL);
    rig_finish(&rig);
    return failed;
}
