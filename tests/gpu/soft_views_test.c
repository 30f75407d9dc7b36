/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares previews and refined frames of the software renderer with those of GL: every pixel (up to a share given in each
   test) and every marker. */
#include "tests/support/test.h"

#include "render/soft/kernels.h"
#include "render/renderer_impl.h"
#include "tests/support/soft_case.h"
#include "tests/support/whole_field.h"

static struct rig rig;
static struct stand stand;

/* Runs the following statement once for previews and once for refined frames. */
#define EACH_TIER(tier) for (enum tier tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++)

TEST(test_home)
{
    EACH_TIER(tier) {
        struct view view = soft_view(&stand, tier, 640, 360);
        soft_assert_like_gl(&stand, &view, tier == TIER_PREVIEW ? 0.002 : 0.005);
    }
}

TEST(test_sizes)
{
    enum { ONE_ROW_MORE = 185 }; /* height in pixels: one row more than whole tiles of the software renderer */
    static const int sizes[][2] = { { 16, 16 }, { 17, 33 }, { 333, 217 }, { 64, 500 }, { 1001, 31 }, { 200, ONE_ROW_MORE } };
    EACH_TIER(tier)
        for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++) {
            struct view view = soft_view(&stand, tier, sizes[i][0], sizes[i][1]);
            soft_assert_like_gl(&stand, &view, tier == TIER_PREVIEW ? 0.01 : 0.08);
        }
}

TEST(test_looks)
{
    static const enum look looks[] = { LOOK_FLAT, LOOK_MATERIALS, LOOK_GLOSSY };
    struct view view = soft_view(&stand, TIER_PREVIEW, 400, 300);
    view.look = LOOK_FLAT;
    view.colormap = (int)colormap_count(NULL) - 1;
    view.range_min = 30; /* range within the readings, so that some values lie below it and some above */
    view.range_max = 70;
    soft_assert_like_gl(&stand, &view, 0.002);
    view = soft_view(&stand, TIER_REFINED, 640, 360);
    for (int i = 0; i < 3; i++) {
        view.look = looks[i];
        soft_assert_like_gl(&stand, &view, view.look == LOOK_FLAT ? 0.005 : 0.01);
    }
    view.look = LOOK_DEFAULT;
    view.range_min = 10;
    view.color_scale.log = true;
    soft_assert_like_gl(&stand, &view, 0.005);
}

/* Cameras around the plant, far away, below it, and among the pipes, where some triangles extend behind the eye. */
TEST(test_cameras)
{
    EACH_TIER(tier) {
        struct view view = soft_view(&stand, tier, 320, 240);
        for (int i = 0; i < 12; i++) {
            stand_look(&stand, i, &view);
            soft_assert_like_gl(&stand, &view, tier == TIER_PREVIEW ? 0.01 : 0.02);
        }
    }
}

/* Orthographic cameras around and above the plant: with a wide field of view, and with a narrow one that stands among the
   pipes. */
TEST(test_orthographic)
{
    for (int i = 0; i < 24; i++) {
        struct view view = soft_view(&stand, i < 12 ? TIER_PREVIEW : TIER_REFINED, 320, 240);
        stand_look(&stand, i % 12, &view);
        view.camera.height_m = i % 3 ? 6 : 1.5;
        view.selected_asset = i < 12 ? i % 4 - 1 : -1;
        if (i < 12 && i % 2)
            soft_lines_every(&view, 10);
        soft_assert_like_gl(&stand, &view, i < 12 ? 0.015 : 0.02);
    }
}

/* Sections by a horizontal plane, by a slanted plane and by a box. Closed bodies get caps; open ones show their inside. */
TEST(test_cuts)
{
    for (int i = 0; i < 36; i++) {
        bool preview = i < 24;
        struct view view = soft_view(&stand, preview ? TIER_PREVIEW : TIER_REFINED, 320, 240);
        stand_look(&stand, i % 12, &view);
        view.camera.height_m = i % 5 == 4 ? 6 : 0;
        view.selected_asset = preview && i % 6 == 5 ? 1 : -1;
        view.look = preview && i % 7 == 3 ? LOOK_FLAT : LOOK_DEFAULT;
        if (i % 3 == 0)
            soft_cut_at(&view, 0, 0, 0, -1, 0.2 + 0.1 * (i % 24));
        if (i % 3 == 1)
            soft_cut_at(&view, 0, 0.6, 0.64, -0.48, 0.3);
        if (i % 3 == 2)
            clip_box(&view.visibility.clip, (double[3]){ -0.8, -0.5, -0.2 }, (double[3]){ 2.1, 0.3, 1.1 });
        soft_assert_like_gl(&stand, &view, preview && view.selected_asset < 0 ? 0.01 : 0.02);
    }
}

TEST(test_sun)
{
    EACH_TIER(tier) {
        struct view view = soft_view(&stand, tier, 400, 300);
        for (int i = 0; i < 4; i++) { /* four light directions, more than the renderer caches */
            double towards[3] = { 0.6 * cos(i), 0.6 * sin(i), 0.8 };
            memcpy(view.light_dir, towards, sizeof(towards));
            soft_assert_like_gl(&stand, &view, tier == TIER_PREVIEW ? 0.003 : 0.01);
        }
    }
}

/* The selected asset's outline is 1.5 pixels wide. Its antialiased edges may differ between software and GL. */
TEST(test_outlines)
{
    struct view view;
    for (int i = 0; i < 2 * (int)stand.toy->scene.asset_count; i++) {
        view = soft_view(&stand, i % 2 ? TIER_PREVIEW : TIER_REFINED, 640, 360);
        view.selected_asset = i / 2;
        soft_assert_like_gl(&stand, &view, i % 2 ? 0.012 : 0.02);
    }
    asset_set_add(&view.visibility.hidden, view.selected_asset);
    struct frame *hidden = test_frame(stand_draw(&stand, &view));
    view.selected_asset = -1;
    struct frame *plain = test_frame(stand_draw(&stand, &view));
    assert_memory_equal(hidden->bgrx, plain->bgrx, (size_t)hidden->height_px * (size_t)hidden->stride_bytes);
}

TEST(test_hidden_assets)
{
    EACH_TIER(tier) {
        struct view view = soft_view(&stand, tier, 320, 240);
        asset_set_add(&view.visibility.hidden, 1);
        soft_assert_like_gl(&stand, &view, tier == TIER_PREVIEW ? 0.003 : 0.01);
    }
}

/* From the third frame of a still camera on, changed readings only recolour the cached frame. More pixels may differ then,
   because recoloured hatching has softer edges. */
TEST(test_still_camera)
{
    struct view view = soft_view(&stand, TIER_PREVIEW, 640, 360);
    view.camera.eye_m[0] += 0.25;
    for (int selected = -1; selected < 2; selected++) {
        view.selected_asset = selected;
        for (int i = 0; i < 4; i++) {
            toy_fill(stand.snapshot, i * 3.0);
            soft_assert_like_gl(&stand, &view, selected < 0 ? 0.01 : 0.02);
        }
        view.colormap = (int)colormap_count(NULL) - 1;
        view.range_max -= 10;
        soft_assert_like_gl(&stand, &view, selected < 0 ? 0.01 : 0.02);
        view.range_min = 10;
        view.color_scale.log = true;
        soft_assert_like_gl(&stand, &view, selected < 0 ? 0.01 : 0.02);
        toy_fill(stand.snapshot, 2.0);
        soft_assert_like_gl(&stand, &view, selected < 0 ? 0.01 : 0.02);
        view = soft_view(&stand, TIER_PREVIEW, 640, 360);
        view.camera.eye_m[0] += 0.25;
    }
    toy_fill(stand.snapshot, 0);
}

/* The camera stands still while the user chooses another group and then the operator view: markers, and the greys of surfaces
   without a field, must be those of the new choice. */
TEST(test_other_group_of_a_still_camera)
{
    struct toy *toy = toy_unit();
    struct plant *plant = &toy->plant;
    struct stand two;
    plant->groups[1] = plant->groups[0];
    plant->group_count = 2;
    for (size_t i = 1; i < plant->tag_count; i += 2)
        plant->tags[i].group = 1;
    stand_init(&two, &rig, toy);
    toy_fill(two.snapshot, 0);
    for (int look = LOOK_DEFAULT; look <= LOOK_MATERIALS; look += LOOK_MATERIALS - LOOK_DEFAULT)
        for (int i = 0; i < 9; i++) {
            struct view view = soft_view(&two, TIER_PREVIEW, 320, 200);
            view.look = (enum look)look;
            view.field.group = i / 3 % 2;
            view.field.show = i < 6 ? SHOW_VALUE : SHOW_OPERATOR;
            soft_assert_like_gl(&two, &view, 0.02);
        }
    stand_finish(&two);
}

/* The camera stands still, and then is moved or an asset is hidden: the next frame must be drawn again and must not reuse the
   cached one. */
TEST(test_moves_after_standing)
{
    struct view view = soft_view(&stand, TIER_PREVIEW, 320, 200);
    for (int i = 0; i < 3; i++)
        soft_assert_like_gl(&stand, &view, 0.01);
    view.camera.eye_m[1] += 0.5;
    soft_assert_like_gl(&stand, &view, 0.01);
    asset_set_add(&view.visibility.hidden, 0);
    soft_assert_like_gl(&stand, &view, 0.01);
}

/* Colours that are computed for each pixel: isolines, bands and logarithmic scales. Pixels at the edges of lines may differ,
   because GL measures the field's slope differently. */
TEST(test_lines_and_scales)
{
    for (int i = 0; i < 5; i++) {
        struct view view = soft_view(&stand, TIER_PREVIEW, 400, 300);
        if (i == 0 || i == 4)
            soft_lines_every(&view, 10);
        view.ramp_interval = i == 1 ? 20 : 0;
        if (i >= 2) {
            view.range_min = 10;
            view.color_scale.log = true;
        }
        view.look = i == 3 ? LOOK_FLAT : LOOK_DEFAULT;
        for (int camera = 0; camera < 4; camera++) {
            soft_assert_like_gl(&stand, &view, 0.012);
            stand_look(&stand, 3 * camera, &view);
        }
    }
}

/* Places the camera in front of the middle of the edge between vertices v and w, so close that the triangles at this edge
   extend far beyond the picture. */
static void look_closely(const struct scene_asset *asset, uint32_t v, uint32_t w, struct view *view)
{
    const struct asset_view *file = &asset->file->view;
    double edge_m = 0, normal[3] = { 0 }, length = 0;
    for (int c = 0; c < 3; c++) {
        double along = (double)file->positions_m[w][c] - (double)file->positions_m[v][c];
        view->camera.target_m[c] = asset->placement[12 + c] + (double)file->positions_m[v][c] + 0.5 * along;
        normal[c] = file->normals[v][c] + file->normals[w][c];
        length += normal[c] * normal[c];
        edge_m += along * along;
    }
    for (int c = 0; c < 3; c++)
        view->camera.eye_m[c] = view->camera.target_m[c] + 2 * sqrt(edge_m / length) * normal[c];
    view->camera.fov_deg = 5;
}

static bool is_rim(int a, int b)
{
    return (a > 127) != (b > 127);
}

/* Borders of hatching (no data, uncertain data) within triangles that are clipped because they extend far beyond the picture.
   */
TEST(test_patterns_close_by)
{
    enum { TANK = 1 }; /* index of the tank, which has a Bad and an Uncertain sensor */
    const struct scene_asset *asset = &stand.toy->scene.assets[TANK];
    int looked = 0, rims = 0;
    struct view view = soft_view(&stand, TIER_PREVIEW, 160, 120);
    view.look = LOOK_FLAT;
    const struct scalars *scalars = field_scalars(stand.field, TANK, &view.field, stand.snapshot);
    assert_non_null(scalars);
    for (uint32_t i = 0; i + 1 < asset->file->view.header->index_count; i++) {
        uint32_t v = asset->file->view.indices[i], w = asset->file->view.indices[i + 1];
        const struct scalar *from = &scalars->at[v], *to = &scalars->at[w];
        if (i % 3 == 2 || !(is_rim(from->lacking, to->lacking) || is_rim(from->uncertain, to->uncertain)) || rims++ % 23 != 0)
            continue;
        look_closely(asset, v, w, &view);
        if (!camera_valid(&view.camera))
            continue;
        struct frame *soft = stand_draw(&stand, &view), *gl = soft_draw_by_gl(&stand, &view);
        soft_assert_same_pixels(soft, gl, 0.02);
        frame_unref(&soft);
        frame_unref(&gl);
        scalars = field_scalars(stand.field, TANK, &view.field, stand.snapshot);
        looked++;
    }
    print_message("# %d places of %d edges where patterns begin\n", looked, rims);
    assert_true(looked >= 8);
}

static void set_limits(bool set)
{
    struct plant *plant = &stand.toy->plant;
    const double limits[LIMIT_COUNT] = { 0, 20, 70, 90 };
    for (size_t tag = 0; tag < plant->tag_count; tag++)
        for (int i = 0; i < LIMIT_COUNT; i++)
            plant->tags[tag].alarms.limits[i] = set && tag != 2 ? limits[i] : NAN;
}

/* The operator view colours the field by the sensors' alarm limits. One tag has no limits, so the surface nearest to it has no
   colour, and assets without a field are grey. */
TEST(test_operator)
{
    set_limits(true);
    EACH_TIER(tier) {
        struct view view = soft_view(&stand, tier, 400, 300);
        view.field.show = SHOW_OPERATOR;
        view_default_scale(&stand.toy->scene, &view);
        for (int camera = 0; camera < 6; camera++) {
            soft_assert_like_gl(&stand, &view, tier == TIER_PREVIEW ? 0.012 : 0.02);
            stand_look(&stand, 2 * camera, &view);
        }
    }
    set_limits(false);
}

/* A frame of a still camera is reused for the same view, but not for the same view with isolines added. */
TEST(test_lines_of_a_still_camera)
{
    struct view view, lined;
    view = soft_view(&stand, TIER_PREVIEW, 400, 300);
    lined = view;
    soft_lines_every(&lined, 10);
    for (int i = 0; i < 3; i++) {
        soft_assert_like_gl(&stand, &view, 0.01);
        soft_assert_like_gl(&stand, &lined, 0.012);
    }
}

/* The implementations of the inner loops (kernels) that are compared with the fastest one that this machine supports. */
static const struct soft_kernels *const other_kernels[] = {
    &soft_kernels_plain,
#ifdef __x86_64__
    &soft_kernels_wide,
#endif
};
enum { OTHER_KERNELS = sizeof(other_kernels) / sizeof(other_kernels[0]) };

static void compare_kernels(const struct view *view, const struct soft_kernels *other)
{
    const struct soft_kernels **kernels = &stand.renderer->by_soft->kernels, *widest = *kernels;
    struct frame *wide = stand_draw(&stand, view);
    *kernels = other;
    /* drawing the same view a second time also tests the kernels that prepare a frame for recolouring */
    struct frame *same = stand_draw(&stand, view);
    *kernels = widest;
    assert_memory_equal(wide->bgrx, same->bgrx, (size_t)wide->stride_bytes * (size_t)wide->height_px);
    assert_non_null(wide->depth[0]);
    assert_true(depth_grid_equal(wide->depth[0], same->depth[0]));
    frame_unref(&wide);
    frame_unref(&same);
}

/* The loops compiled for different vector widths must give bit-identical frames and depth grids. */
TEST(test_kernels)
{
    const struct soft_kernels *widest = stand.renderer->by_soft->kernels;
    /* widths at which the last tile has 16 or 8 columns, or another number; the heights below leave a last tile of one row */
    static const int widths_px[] = { 640, 333, 37, 322, 330 };
    struct view view;
    if (widest == &soft_kernels_plain) {
        print_message("SKIP: this machine has no wider registers\n");
        skip();
    }
    renderer_set_depth(stand.renderer, true);
    for (int i = 0; i < 24 * OTHER_KERNELS; i++) {
        if (other_kernels[i / 24] == widest)
            break;
        view = soft_view(&stand, TIER_PREVIEW, widths_px[i % 5], widths_px[i % 5] * 9 / 16);
        stand_look(&stand, i % 24 / 2, &view);
        view.selected_asset = i % 4 == 2 ? 0 : -1;
        if (i % 4 == 1)
            soft_lines_every(&view, 5);
        if (i % 5 == 3)
            soft_cut_at(&view, 0, 0.6, 0.64, -0.48, 0.3);
        compare_kernels(&view, other_kernels[i / 24]);
    }
    renderer_set_depth(stand.renderer, false);
}

/* Views in which only the sky is visible: wide and tall pictures, narrow and wide angles, level and tilted cameras. */
TEST(test_sky)
{
    static const int sizes_px[][2] = { { 640, 360 }, { 1600, 40 }, { 40, 600 }, { 320, 240 } };
    static const double fovs_deg[] = { 10, 40, 100, 140 };
    int worst = 0;
    for (int i = 0; i < 4 * 4 * 3; i++) {
        struct view view;
        double lean = i / 16 * 0.7;
        view = soft_view(&stand, TIER_PREVIEW, sizes_px[i % 4][0], sizes_px[i % 4][1]);
        view.camera.fov_deg = fovs_deg[i / 4 % 4];
        for (int c = 0; c < 3; c++) {
            view.camera.eye_m[c] = stand.toy->scene.bounds_max_m[c] + 5;
            view.camera.target_m[c] = view.camera.eye_m[c] + (c < 2 ? 1 : 1.2);
            view.camera.up[c] = c < 2 ? sin(lean) * (c ? 1 : -1) : cos(lean);
        }
        struct frame *soft = stand_draw(&stand, &view), *gl = soft_draw_by_gl(&stand, &view);
        int most = 0;
        for (int k = 0; k < gl->width_px * gl->height_px; k++) {
            int by = soft_difference(soft, gl, k);
            most = by > most ? by : most;
        }
        if (most > 2)
            print_message("# %dx%d, %g degrees, leaning %.1f: %d of 255\n", view.width_px, view.height_px, view.camera.fov_deg, lean, most);
        worst = most > worst ? most : worst;
        frame_unref(&soft);
        frame_unref(&gl);
    }
    assert_in_range(worst, 0, 2);
}

/* Ghosts (translucent assets) in front of and behind other assets, with section planes; in previews also with a still camera.
   */
TEST(test_ghosts)
{
    for (int i = 0; i < 24; i++) {
        enum tier tier = i < 12 ? TIER_PREVIEW : TIER_REFINED;
        struct view view = soft_view(&stand, tier, 320, 240);
        stand_look(&stand, i % 12, &view);
        view.dark = i % 2;
        view.camera.height_m = i % 12 == 6 ? 6 : 0;
        /* asset 0 is shown in frame 7; asset 1 is a ghost, which is outlined, too */
        view.selected_asset = i == 7 ? 0 : i % 3 == 1 ? 1 : -1;
        asset_set_add(&view.visibility.ghosts, i % 4);
        asset_set_add(&view.visibility.ghosts, 1);
        if (i % 4 == 3)
            soft_cut_at(&view, 0, 0.6, 0.64, -0.48, 0.3);
        for (int again = 0; again < (tier == TIER_PREVIEW ? 3 : 1); again++)
            soft_assert_like_gl(&stand, &view, 0.02);
    }
}

/* The looks `glossy` and `materials`. More pixels may differ than in the default look, because light adds small steps of
   brightness to those of the colours. */
TEST(test_gloss_and_materials)
{
    for (int i = 0; i < 8; i++) {
        struct view view = soft_view(&stand, TIER_PREVIEW, 320, 240);
        stand_look(&stand, i, &view);
        view.look = i % 2 ? LOOK_GLOSSY : LOOK_MATERIALS;
        view.dark = i % 4 == 3;
        for (int again = 0; again < (i < 2 ? 3 : 1); again++)
            soft_assert_like_gl(&stand, &view, again < 2 ? 0.012 : 0.03); /* recoloured hatching has softer edges */
        view.look = LOOK_DEFAULT;
        soft_assert_like_gl(&stand, &view, 0.01);
    }
}

int main(void)
{
    return soft_run("soft_views_test", &rig, &stand, toy_unit);
}
