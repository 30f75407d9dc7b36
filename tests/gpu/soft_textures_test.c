/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Materials with textures, holes and glass: frames of the software renderer compared with those of GL. */
#include "tests/support/test.h"

#include "tests/support/no_textures.h"
#include "tests/support/soft_case.h"
#include "value/quality.h"

static struct rig rig;
static struct stand stand;

/* indices of the plates (assets), in the order in which make_plant() adds them */
enum { WALL, GRATING, SIGN, FENCE, WINDOW, CURTAIN, PLATES };
enum { PAINTED, GRATE, GLASS, SMOKE, STEEL, MATERIALS };
enum { BASE, GLOSS, BUMPS, CREASES, LAMPS, HOLES, HAZE, TEXTURES };
enum { SIDE_PX = 64, TEXELS = SIDE_PX * SIDE_PX, MOST_VERTICES = 1024 };
static uint8_t texels[TEXTURES * TEXELS][4];
static struct asset_texture textures[TEXTURES];
static struct asset_material materials[MATERIALS];
static float texcoords[MOST_VERTICES][2];

static uint8_t wave(double x)
{
    return (uint8_t)(127.5 + 127.5 * sin(2 * M_PI * x));
}

static void paint_texels(void)
{
    for (int i = 0; i < TEXELS; i++) {
        double x = (double)(i % SIDE_PX) / SIDE_PX, y = (double)(i / SIDE_PX) / SIDE_PX, away = hypot(x - 0.5, y - 0.5);
        bool square = (int)(8 * x) % 2 == (int)(8 * y) % 2;
        const uint8_t of[TEXTURES][4] = {
            [BASE] = { wave(x), square ? 200 : 60, wave(2 * y), 255 },
            [GLOSS] = { 0, (uint8_t)(60 + 180 * y), square ? 255 : 0, 255 },
            [BUMPS] = { (uint8_t)(128 + 60 * sin(4 * M_PI * x)), (uint8_t)(128 + 60 * sin(4 * M_PI * y)), 240, 255 },
            [CREASES] = { wave(x + y), 0, 0, 255 },
            [LAMPS] = { away < 0.2 ? 255 : 0, away < 0.2 ? 180 : 0, 0, 255 },
            [HOLES] = { 220, 210, 200, away < 0.35 ? 0 : 255 },
            [HAZE] = { 255, 255, 255, wave(x) },
        };
        for (int t = 0; t < TEXTURES; t++)
            memcpy(texels[t * TEXELS + i], of[t], 4);
    }
    for (int t = 0; t < TEXTURES; t++)
        textures[t] = (struct asset_texture){ .offset = (uint64_t)t * TEXELS * sizeof(texels[0]),
                                              .width_px = SIDE_PX,
                                              .height_px = SIDE_PX,
                                              .srgb = t == BASE || t == LAMPS,
                                              .wrap_repeat = t != BASE };
}

static void make_materials(void)
{
    for (int m = 0; m < MATERIALS; m++)
        materials[m] = (struct asset_material){ .base_color = { 0.8f, 0.8f, 0.8f, 1 },
                                                .roughness = 0.6f,
                                                .normal_scale = 0.8f,
                                                .occlusion_strength = 0.7f,
                                                .alpha_cutoff = 0.5f,
                                                .double_sided = m == GRATE || m == GLASS,
                                                NO_TEXTURES };
    struct asset_material *sign = &materials[PAINTED], *grate = &materials[GRATE], *glass = &materials[GLASS], *smoke = &materials[SMOKE];
    sign->base_color_texture = BASE;
    sign->metallic_roughness_texture = GLOSS;
    sign->normal_texture = BUMPS;
    sign->occlusion_texture = CREASES;
    sign->emissive_texture = LAMPS;
    sign->metallic = sign->emissive[0] = sign->emissive[1] = 1;
    grate->alpha = ASSET_ALPHA_MASK;
    grate->base_color_texture = HOLES;
    glass->alpha = smoke->alpha = ASSET_ALPHA_BLEND;
    memcpy(glass->base_color, (float[4]){ 0.1f, 0.5f, 0.6f, 0.4f }, sizeof(glass->base_color));
    smoke->base_color_texture = HAZE;
}

/* Adds a vertical plate; its texture repeats `times` times along each side. */
static void add_plate(struct toy *toy, const char *id, uint32_t material, double times, const double at_m[3], int sensors)
{
    static const double places[4][3] = { { 0.2, 0, 0.2 }, { 2.2, 0.3, 1.6 }, { 1.2, 0.2, 0.9 }, { 0.2, 0.2, 1.6 } };
    struct test_shape shape = { .materials = materials,
                                .textures = textures,
                                .texels = texels[0],
                                .texcoords = (const float(*)[2])texcoords,
                                .material_count = MATERIALS,
                                .texture_count = TEXTURES,
                                .texel_bytes = sizeof(texels) };
    shape_plate(&shape, material, (double[3]){ 0, 0, 0 }, (double[3]){ 2.4, 0.3, 0 }, (double[3]){ 0, 0.2, 1.8 }, 6);
    assert_true(shape.vertex_count <= MOST_VERTICES);
    for (size_t v = 0; v < shape.vertex_count; v++) {
        texcoords[v][0] = shape.positions[v][0] * (float)(times / 2.4);
        texcoords[v][1] = shape.positions[v][2] * (float)(times / 1.8);
    }
    toy_add(toy, id, &shape, at_m, places, (size_t)sensors);
}

static struct toy *make_plant(void)
{
    struct toy *toy = toy_create();
    paint_texels();
    make_materials();
    add_plate(toy, "WALL", STEEL, 1, (double[3]){ 0, 2, 0 }, 4);
    add_plate(toy, "GRATING", GRATE, 6, (double[3]){ 1.6, 1, 0.3 }, 4); /* tags as toy_fill() has them */
    add_plate(toy, "SIGN", PAINTED, 1, (double[3]){ -1.8, 1.6, 0 }, 0);
    add_plate(toy, "FENCE", GRATE, 9, (double[3]){ -1.2, 0.8, -0.2 }, 0);
    add_plate(toy, "WINDOW", GLASS, 1, (double[3]){ 0.3, 0, 0.4 }, 0);
    add_plate(toy, "CURTAIN", SMOKE, 2, (double[3]){ -0.8, 0.3, 0.5 }, 0);
    return toy;
}

static void look(struct view *view, enum tier tier, int i)
{
    *view = soft_view(&stand, tier, 480, 320);
    view->camera = (struct camera){ .eye_m = { 1 + 2.5 * (i % 3 - 1), i % 4 == 3 ? -1.5 : -4, 1 + 0.8 * (i % 4) },
                                    .target_m = { 1, 1, 0.9 },
                                    .up = { 0, 0, 1 },
                                    .fov_deg = 50,
                                    .height_m = i % 5 == 4 ? 3.5 : 0 };
}

/* Draws twelve views from both sides, near and far, in several looks, some with section planes or a selected asset. At most the
   fraction may_differ of the pixels may differ between software and GL. */
static void compare_all(enum tier tier, double may_differ)
{
    for (int i = 0; i < 12; i++) {
        struct view view;
        look(&view, tier, i);
        view.look = i % 4 == 1 ? LOOK_MATERIALS : i % 4 == 2 ? LOOK_GLOSSY : LOOK_DEFAULT;
        view.dark = i == 7;
        view.selected_asset = i % 3 == 2 ? i % 6 : -1;
        if (i == 6)
            soft_cut_at(&view, 0, 0, 0, -1, 1.3);
        if (i == 8)
            asset_set_add(&view.visibility.ghosts, 3);
        if (i == 9)
            view.camera.eye_m[1] = 6;
        soft_assert_like_gl(&stand, &view, may_differ);
    }
}

TEST(test_previews)
{
    compare_all(TIER_PREVIEW, 0.02);
}

TEST(test_refined)
{
    /* more differences than in previews, because the refined software frame has smooth rims of holes and always blends panes in
       order of depth */
    compare_all(TIER_REFINED, 0.06);
}

/* Draws each plate alone, so that a difference is due to this plate, with a limit of its own for the share of pixels that may
   differ. */
TEST(test_each)
{
    static const double may_differ[] = { [SIGN] = 0.003, [FENCE] = 0.03, [WINDOW] = 0.002, [CURTAIN] = 0.002 };
    for (int asset = SIGN; asset < PLATES; asset++)
        for (int i = 0; i < 3; i++) {
            struct view view;
            look(&view, TIER_REFINED, i);
            view.look = i ? LOOK_MATERIALS : LOOK_DEFAULT;
            for (int other = GRATING; other < PLATES; other++)
                if (other != asset)
                    asset_set_add(&view.visibility.hidden, other);
            soft_assert_like_gl(&stand, &view, may_differ[asset]);
        }
}

/* After readings have changed, surfaces seen through glass and gratings are only recoloured. The result must equal a frame that
   is drawn completely. */
TEST(test_new_readings)
{
    struct view view;
    for (int i = 0; i < 4; i++) {
        look(&view, TIER_REFINED, i);
        toy_set(stand.snapshot, 0, 30, QUALITY_GOOD);
        struct frame *first = soft_draw_anew(&stand, &view);
        toy_set(stand.snapshot, 0, 90, i % 2 ? QUALITY_GOOD : QUALITY_UNCERTAIN_LAST_USABLE);
        struct frame *again = stand_draw(&stand, &view), *anew = soft_draw_anew(&stand, &view);
        size_t bytes = (size_t)anew->stride_bytes * (size_t)anew->height_px;
        assert_memory_equal(again->bgrx, anew->bgrx, bytes);
        assert_memory_not_equal(again->bgrx, first->bgrx, bytes);
        frame_unref(&first);
        frame_unref(&again);
        frame_unref(&anew);
    }
}

int main(void)
{
    return soft_run("soft_textures_test", &rig, &stand, make_plant);
}
