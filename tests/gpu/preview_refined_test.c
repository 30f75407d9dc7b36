/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nothing jumps from preview to refined: colours stay close, and holes cut by textures are the same. Every texture of a
   material has the effect that glTF specifies. */
#include "tests/support/test.h"

#include "base/color/lab.h"
#include "base/math/search.h"
#include "render/split_view.h"
#include "scene/framing.h"
#include "tests/support/no_textures.h"
#include "tests/support/site.h"
#include "tests/support/rig_case.h"
#include "value/quality.h"

/* --- difference between the preview and the refined tier --------------------------------------------------------------------------- */

struct gap {
    /* mean: mean difference of all channels, in levels of 0 to 255; far_part: share of pixels of which a channel differs by
       more than 32 */
    double mean, far_part;
    int most;              /* largest difference of a channel, without pixels at edges, because only the refined tier antialiases these */
};

static bool is_edge(const struct frame *frame, int x, int y)
{
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 9; k++)
            if (abs(frame_pixel(frame, x, y)[c] - frame_pixel(frame, x + k % 3 - 1, y + k / 3 - 1)[c]) > 10)
                return true;
    return false;
}

static struct gap measure(struct stand *stand, struct view *view)
{
    struct gap gap = { 0 };
    double pixels = (view->width_px - 2.0) * (view->height_px - 2.0);
    view->tier = TIER_PREVIEW;
    struct frame *moving = stand_draw(stand, view);
    view->tier = TIER_REFINED;
    struct frame *still = stand_draw(stand, view);
    for (int y = 1; y < view->height_px - 1; y++)
        for (int x = 1; x < view->width_px - 1; x++) {
            int most = 0;
            for (int c = 0; c < 3; c++) {
                int by = abs(frame_pixel(moving, x, y)[c] - frame_pixel(still, x, y)[c]);
                gap.mean += by / (3 * pixels);
                most = by > most ? by : most;
            }
            gap.far_part += (most > 32) / pixels;
            if (most > gap.most && !is_edge(moving, x, y) && !is_edge(still, x, y))
                gap.most = most;
        }
    frame_unref(&moving);
    frame_unref(&still);
    return gap;
}

static void assert_calm(const char *what, struct stand *stand, struct view *view, struct gap bound)
{
    struct gap gap = measure(stand, view);
    print_message("# %s: %.2f levels on average, %.2f %% of the pixels off by more than 32, at most %d away from edges\n", what, gap.mean,
                  100 * gap.far_part, gap.most);
    assert_true(gap.mean <= bound.mean && gap.far_part <= bound.far_part && gap.most <= bound.most);
}

TEST(test_the_unit_does_not_flash)
{
    struct stand stand;
    struct view view;
    stand_init(&stand, &rig, toy_unit());
    for (int i = 0; i < 8; i++)
        toy_set(stand.snapshot, i, 20 + 7 * i, QUALITY_GOOD);
    view_default(&stand.toy->scene, 640, 360, &view);
    assert_calm("unit", &stand, &view, (struct gap){ 2.0, 0.03, 60 });
    for (int i = 0; i < 3; i++) {
        double turn = 2.1 * i;
        memcpy(view.light_dir, (double[3]){ 0.8 * cos(turn), 0.8 * sin(turn), 0.6 }, sizeof(view.light_dir));
        assert_calm("unit, another sun", &stand, &view, (struct gap){ 2.5, 0.04, 60 });
    }
    stand_finish(&stand);
}

/* --- real plants -------------------------------------------------------------------------------------------------------------------- */

enum { BLOCK = 4 }; /* side of a block in pixels; averaging over a block hides the antialiasing of edges */
struct flash {      /* delta E (CIE 1976) between a block's mean colours in preview and refined */
    double mean, p95;
};

static void block_lab(const struct frame *frame, int column, int row, double lab[3])
{
    double rgb[3] = { 0 };
    for (int i = 0; i < BLOCK * BLOCK; i++)
        for (int c = 0; c < 3; c++)
            rgb[c] += frame_pixel(frame, column * BLOCK + i % BLOCK, row * BLOCK + i / BLOCK)[2 - c] / (double)(BLOCK * BLOCK);
    lab_from_srgb(rgb, VISION_NORMAL, lab);
}

static struct flash flash_of(struct site *site, struct view *view)
{
    int columns = view->width_px / BLOCK, count = columns * (view->height_px / BLOCK);
    double *errors = mem_array((size_t)count, sizeof(*errors)), sum = 0;
    struct frame *frames[2];
    for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++) {
        view->tier = (enum tier)tier;
        frames[tier] = split_view_draw_now(site->renderer, view, site->snapshot);
        assert_non_null(frames[tier]);
    }
    for (int i = 0; i < count; i++) {
        double lab[2][3], square = 0;
        for (int f = 0; f < 2; f++)
            block_lab(frames[f], i % columns, i / columns, lab[f]);
        for (int c = 0; c < 3; c++)
            square += (lab[0][c] - lab[1][c]) * (lab[0][c] - lab[1][c]);
        sum += errors[i] = sqrt(square);
    }
    qsort(errors, (size_t)count, sizeof(*errors), compare_doubles);
    struct flash flash = { sum / count, errors[count * 95 / 100] };
    mem_free(errors);
    frame_unref(&frames[0]);
    frame_unref(&frames[1]);
    return flash;
}

/* Compares the tiers in six views: the plant's own and five near assets, the last one with the model's materials; every second
   one has a dark backdrop. Asserts that they differ little, except for dark outlines, which previews lack. */
static void assert_no_flash(const char *path, const char *name)
{
    enum { VIEWS = 6 };
    struct site site;
    assert_true(site_init(&site, &rig, path, name));
    for (int i = 0; i < VIEWS; i++) {
        struct view view;
        view_default(site.scene, 640, 360, &view);
        struct framing framing = { .asset = (int)((size_t)i * site.scene->asset_count / VIEWS), .tag = -1, .side = SIDE_ISO };
        if (i > 0)
            framing_look(site.scene, &framing, 16.0 / 9, &view.camera);
        view.look = i == VIEWS - 1 ? LOOK_MATERIALS : LOOK_DEFAULT;
        view.dark = i % 2 == 1;
        struct flash flash = flash_of(&site, &view);
        print_message("# %s, view %d: delta E %.2f on average, %.2f (p95)\n", name ? name : "demo", i, flash.mean, flash.p95);
        bool materials = view.look == LOOK_MATERIALS; /* materials are drawn in full contrast */
        assert_true(flash.mean < (materials ? 4 : 3) && flash.p95 < (materials ? 14 : 10));
    }
    site_finish(&site);
}

TEST(test_the_demo_does_not_flash)
{
    assert_no_flash(SITE_DEMO, NULL);
}

TEST(test_a_real_plant_does_not_flash)
{
    if (!site_is_there("plm_plant_equipment.glb"))
        skip();
    assert_no_flash("tests/plants/plant_room.yaml", "plant_room");
}

/* --- textures ------------------------------------------------------------------------------------------------------------------------ */

enum { CELLS = 8, TEXELS = CELLS * CELLS };
struct textured_plate {
    uint8_t texels[TEXELS][4];
    struct asset_texture texture;
    struct asset_material material;
    float (*texcoords)[2];
    struct stand stand;
    struct view view;
    bool floor; /* true: adds a floor 1 m below the plate, three times as wide */
};

/* Makes a horizontal square of 2 m, x and y from -1 to 1, seen from above; the texture's columns run along x and its rows along y. */
static void plate_init(struct textured_plate *plate, const double (*sensors)[3], size_t sensor_count)
{
    struct toy *toy = toy_create();
    struct test_shape shape = { .materials = &plate->material,
                                .material_count = 1,
                                .textures = &plate->texture,
                                .texture_count = 1,
                                .texels = plate->texels[0],
                                .texel_bytes = sizeof(plate->texels) };
    plate->texture.width_px = plate->texture.height_px = CELLS;
    shape_plate(&shape, 0, (double[3]){ -1, -1, 0 }, (double[3]){ 2, 0, 0 }, (double[3]){ 0, 2, 0 }, 16);
    plate->texcoords = mem_array(shape.vertex_count, sizeof(*plate->texcoords));
    for (size_t i = 0; i < shape.vertex_count; i++)
        for (int c = 0; c < 2; c++)
            plate->texcoords[i][c] = (shape.positions[i][c] + 1) / 2;
    shape.texcoords = (void *)plate->texcoords;
    toy_add(toy, "plate", &shape, (double[3]){ 0, 0, 0 }, sensors, sensor_count);
    if (plate->floor) {
        struct test_shape floor = { 0 };
        shape_plate(&floor, TOY_CONCRETE, (double[3]){ -3, -3, 0 }, (double[3]){ 6, 0, 0 }, (double[3]){ 0, 6, 0 }, 48);
        toy_add(toy, "floor", &floor, (double[3]){ 0, 0, -1 }, NULL, 0);
    }
    stand_init(&plate->stand, &rig, toy);
    for (size_t i = 0; i < sensor_count; i++)
        toy_set(plate->stand.snapshot, (int)i, 50, QUALITY_GOOD);
    view_default(&toy->scene, 200, 200, &plate->view);
    plate->view.camera = (struct camera){ .eye_m = { 0, 0, 4 }, .up = { 0, 1, 0 }, .fov_deg = 45, .height_m = 2.2 };
    plate->view.look = sensor_count ? LOOK_DEFAULT : LOOK_MATERIALS;
    memcpy(plate->view.light_dir, (double[3]){ 0.6, 0, 0.8 }, sizeof(plate->view.light_dir));
}

static void plate_finish(struct textured_plate *plate)
{
    stand_finish(&plate->stand);
    mem_free(plate->texcoords);
}

/* Returns a grey plate without textures. All its texels are white, so that a test can paint some and then use them as a
   texture. */
static struct textured_plate plain_plate(void)
{
    struct textured_plate plate = { .material = { .base_color = { 0.5f, 0.5f, 0.5f, 1 },
                                                  .roughness = 0.8f,
                                                  .normal_scale = 1,
                                                  .occlusion_strength = 1,
                                                  .alpha_cutoff = 0.5f,
                                                  NO_TEXTURES } };
    memset(plate.texels, 255, sizeof(plate.texels));
    return plate;
}

static void paint_right(struct textured_plate *plate, const uint8_t rgba[4])
{
    for (int i = 0; i < TEXELS; i++)
        if (i % CELLS >= CELLS / 2)
            memcpy(plate->texels[i], rgba, 4);
}

/* Returns the pixels in the middle of the left half and of the right half. */
static void halves(struct textured_plate *plate, enum tier tier, int left[3], int right[3])
{
    plate->view.tier = tier;
    struct frame *frame = stand_draw(&plate->stand, &plate->view);
    for (int c = 0; c < 3; c++) {
        left[c] = frame_pixel(frame, 60, 100)[2 - c];
        right[c] = frame_pixel(frame, 140, 100)[2 - c];
    }
    frame_unref(&frame);
}

TEST(test_base_color)
{
    struct textured_plate plate = plain_plate();
    int left[3], right[3];
    plate.material.base_color_texture = 0;
    plate.texture.srgb = 1;
    paint_right(&plate, (uint8_t[4]){ 255, 40, 40, 255 });
    plate_init(&plate, NULL, 0);
    halves(&plate, TIER_REFINED, left, right);
    assert_true(abs(left[0] - left[1]) < 12 && right[0] > left[0] - 40 && right[1] < left[1] - 60 && right[2] < left[2] - 60);
    plate_finish(&plate);
}

TEST(test_metal_and_roughness)
{
    struct textured_plate plate = plain_plate();
    int left[3], right[3];
    plate.material.metallic_roughness_texture = 0;
    plate.material.metallic = 1;
    plate.material.base_color[1] = plate.material.base_color[2] = 0.1f;
    memset(plate.texels, 0, sizeof(plate.texels));
    for (int i = 0; i < TEXELS; i++)
        memcpy(plate.texels[i], i % CELLS < CELLS / 2 ? (uint8_t[4]){ 0, 255, 0, 255 } : (uint8_t[4]){ 0, 60, 255, 255 }, 4);
    plate_init(&plate, NULL, 0);
    halves(&plate, TIER_REFINED, left, right);
    /* the left half is a dielectric, which the sun lights; the right half is a metal, which only mirrors the sky and so is
       darker */
    assert_true(left[0] > right[0] + 8);
    plate_finish(&plate);
}

TEST(test_normals)
{
    struct textured_plate plate = plain_plate();
    int left[3], right[3];
    plate.material.normal_texture = 0;
    /* left half: normals tilted towards the sun, which is on the right; right half: normals tilted away from it */
    for (int i = 0; i < TEXELS; i++)
        memcpy(plate.texels[i], i % CELLS < CELLS / 2 ? (uint8_t[4]){ 204, 128, 230, 255 } : (uint8_t[4]){ 52, 128, 230, 255 }, 4);
    plate_init(&plate, NULL, 0);
    halves(&plate, TIER_REFINED, left, right);
    print_message("# towards the sun %d, away from it %d\n", left[1], right[1]);
    assert_true(left[1] > right[1] + 30);
    plate_finish(&plate);
}

TEST(test_occlusion_and_glow)
{
    struct textured_plate plate = plain_plate();
    int left[3], right[3];
    plate.material.occlusion_texture = 0;
    paint_right(&plate, (uint8_t[4]){ 0, 255, 255, 255 });
    plate_init(&plate, NULL, 0);
    halves(&plate, TIER_REFINED, left, right);
    assert_true(left[1] > right[1] + 15);
    plate_finish(&plate);
    plate = plain_plate();
    plate.material.emissive_texture = 0;
    plate.material.emissive[1] = 0.8f;
    paint_right(&plate, (uint8_t[4]){ 0, 0, 0, 255 });
    plate_init(&plate, NULL, 0);
    halves(&plate, TIER_REFINED, left, right);
    assert_true(left[1] > left[0] + 25 && abs(right[1] - right[0]) < 12);
    plate_finish(&plate);
}

/* A grating has the same holes in both tiers, with and without a sensor. */
TEST(test_holes_are_holes_in_both_tiers)
{
    static const double sensor[1][3] = { { -0.5, 0, 0 } };
    for (size_t sensors = 0; sensors < 2; sensors++) {
        struct textured_plate plate = plain_plate();
        int left[3], right[3], still_left[3], still_right[3];
        plate.material.alpha = ASSET_ALPHA_MASK;
        plate.material.base_color[0] = plate.material.base_color[1] = plate.material.base_color[2] = 0.02f;
        plate.material.base_color_texture = 0;
        paint_right(&plate, (uint8_t[4]){ 255, 255, 255, 0 });
        plate_init(&plate, sensor, sensors);
        plate.view.look = LOOK_DEFAULT;
        halves(&plate, TIER_PREVIEW, left, right);
        halves(&plate, TIER_REFINED, still_left, still_right);
        for (int c = 0; c < 3; c++)
            assert_true(abs(left[c] - still_left[c]) <= 20 && abs(right[c] - still_right[c]) <= 20);
        print_message("# %d sensors: %d %d %d, hole %d %d %d\n", (int)sensors, left[0], left[1], left[2], right[0], right[1], right[2]);
        assert_true(abs(left[0] - right[0]) + abs(left[1] - right[1]) + abs(left[2] - right[2]) > 20);
        plate_finish(&plate);
    }
}

/* A plate with a floor 1 m below; its texture makes the right half, x from 0 to 1, a hole. The sun shines from the right, so
   the plate's shadow on the floor is shifted 0.75 m to the left. */
TEST(test_holes_let_the_sun_through)
{
    for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++) {
        struct textured_plate plate = plain_plate();
        plate.floor = true;
        plate.material.alpha = ASSET_ALPHA_MASK;
        plate.material.base_color_texture = 0;
        paint_right(&plate, (uint8_t[4]){ 255, 255, 255, 0 });
        plate_init(&plate, NULL, 0);
        plate.view.tier = (enum tier)tier;
        plate.view.camera.height_m = 6;
        struct frame *frame = stand_draw(&plate.stand, &plate.view);
        /* pixels of the floor left of the plate's shadow, at x = -2.5 m, and in it, at x = -1.3 m */
        int lit = frame_pixel(frame, 17, 100)[1], shaded = frame_pixel(frame, 57, 100)[1];
        /* pixels of the floor seen through the hole, at x = 0.12 m and 0.6 m: both are lit */
        int through = frame_pixel(frame, 104, 100)[1], beside = frame_pixel(frame, 120, 100)[1];
        print_message("# lit %d, shaded %d; through the hole %d, beside its shadow %d\n", lit, shaded, through, beside);
        assert_true(shaded < lit - 30 && abs(through - beside) < 12 && through > shaded + 20);
        frame_unref(&frame);
        plate_finish(&plate);
    }
}

/* Context is drawn in muted colours, so where one tier draws its textures, the other must show nearly their mean colour. */
TEST(test_textured_context_does_not_flash)
{
    struct textured_plate plate = plain_plate();
    plate.material.base_color_texture = 0;
    plate.texture.srgb = 1;
    for (int i = 0; i < TEXELS; i++)
        memcpy(plate.texels[i], (i + i / CELLS) % 2 ? (uint8_t[4]){ 200, 180, 150, 255 } : (uint8_t[4]){ 110, 110, 120, 255 }, 4);
    plate_init(&plate, NULL, 0);
    plate.view.look = LOOK_DEFAULT;
    assert_calm("textured plate", &plate.stand, &plate.view, (struct gap){ 20, 0.05, 50 });
    plate_finish(&plate);
}
