/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests views with hidden, isolated, ghosted and clipped assets (which pixels and markers are drawn, and when the content hash
   changes), and orthographic cameras. All tests run twice: drawn in software as for a session without a GPU (which leaves some
   views to GL, and these must match), then drawn by GL only. */
#include "tests/support/test.h"

#include "render/pick/pick.h"
#include "tests/support/planned.h"
#include "tests/support/rig.h"
#include "value/quality.h"

enum { EXCHANGER, TANK, PIPE, SLAB, PUMP };
static struct rig rig;
static struct stand stand;
static struct view view;
static bool by_gl;

static void set_up(struct stand *own, struct toy *toy)
{
    stand_init(own, &rig, toy);
    renderer_use_gl(own->renderer, by_gl);
}

/* Sets the exchanger's sensors to 30 degrees and the tank's to 80, so that each of the two assets has one colour; also resets
   the view. */
static int reset(void **state)
{
    (void)state;
    for (int i = 0; i < 8; i++)
        toy_set(stand.snapshot, i, i < 5 ? 30 : 80, QUALITY_GOOD);
    view_default(&stand.toy->scene, 480, 270, &view);
    view.tier = TIER_PREVIEW;
    view.look = LOOK_FLAT;
    return 0;
}

/* Counts the pixels with exactly the colour that the legend gives this value, 0 to 100. */
static int count_value(const struct frame *frame, double value)
{
    const struct colormap *map = colormap_at(NULL, (size_t)view.colormap);
    int count = 0, index = (int)(value / 100 * 256);
    for (int y = 0; y < frame->height_px; y++)
        for (int x = 0; x < frame->width_px; x++)
            count += map_index_exact(map, frame_pixel(frame, x, y)) == index;
    return count;
}

enum { ROUNDING = 3 }; /* largest difference of a channel that counts as equal between frames drawn by GL and in software */

static int count_farther(const struct frame *a, const struct frame *b, int most)
{
    int count = 0;
    for (int y = 0; y < a->height_px; y++)
        for (int x = 0; x < a->width_px; x++) {
            const uint8_t *one = frame_pixel(a, x, y), *other = frame_pixel(b, x, y);
            count += abs(one[0] - other[0]) > most || abs(one[1] - other[1]) > most || abs(one[2] - other[2]) > most;
        }
    return count;
}

static int count_different(const struct frame *a, const struct frame *b)
{
    return count_farther(a, b, 0);
}

static void assert_looks(double exchanger_least, double tank_least, size_t markers)
{
    for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++) {
        view.tier = (enum tier)tier;
        struct frame *frame = stand_draw(&stand, &view);
        int exchanger = count_value(frame, 30), tank = count_value(frame, 80);
        assert_true(exchanger_least > 0 ? exchanger > exchanger_least : exchanger == 0);
        assert_true(tank_least > 0 ? tank > tank_least : tank == 0);
        assert_int_equal(frame->marker_count, markers);
        frame_unref(&frame);
    }
    view.tier = TIER_PREVIEW;
}

TEST_WITH(test_hidden_and_isolated, reset, NULL)
{
    assert_looks(2000, 2000, 8);
    asset_set_add(&view.visibility.hidden, TANK);
    assert_looks(2000, 0, 5);
    memset(&view.visibility, 0, sizeof(view.visibility));
    asset_set_add(&view.visibility.isolated, TANK);
    assert_looks(0, 2000, 3);
    asset_set_add(&view.visibility.hidden, TANK);
    assert_looks(0, 0, 0);
    struct frame *frame = test_frame(stand_draw(&stand, &view));
    assert_int_equal(frame->triangles, 0);
}

TEST_WITH(test_what_is_hidden_has_no_age, reset, NULL)
{
    for (int i = 5; i < 8; i++)
        stand.snapshot->readings[i].age_ns = 9000000000;
    asset_set_add(&view.visibility.hidden, TANK);
    struct frame *frame = test_frame(stand_draw(&stand, &view));
    assert_true(frame->oldest_age_ns == 1000000000);
}

static uint64_t content(void)
{
    return planned_content(stand.renderer, &view, stand.snapshot);
}

TEST_WITH(test_content_sees_what_is_shown, reset, NULL)
{
    uint64_t whole = content();
    asset_set_add(&view.visibility.hidden, TANK);
    uint64_t hidden = content();
    view.visibility = (struct visibility){ 0 };
    asset_set_add(&view.visibility.ghosts, TANK);
    uint64_t ghost = content();
    view.visibility = (struct visibility){ 0 };
    clip_box(&view.visibility.clip, (double[3]){ -9, -9, -9 }, (double[3]){ 9, 9, 1 });
    uint64_t cut = content();
    assert_true(whole != hidden && whole != ghost && whole != cut && hidden != ghost && ghost != cut);
    clip_box(&view.visibility.clip, (double[3]){ -9, -9, -9 }, (double[3]){ 9, 9, 1.1 });
    assert_true(content() != cut);
    view.visibility = (struct visibility){ 0 };
    assert_true(content() == whole);
    view.visibility.isolated = (struct asset_set){ 0 };
    for (int i = 0; i < 5; i++) /* isolating all five assets must give the same frame as isolating none */
        asset_set_add(&view.visibility.isolated, i);
    struct frame *all = test_frame(stand_draw(&stand, &view));
    view.visibility = (struct visibility){ 0 };
    struct frame *none = test_frame(stand_draw(&stand, &view));
    assert_int_equal(all->triangles, none->triangles);
}

/* The tank stands in front of the exchanger's end. Seen through the ghosted tank, that end must have the same colours as with a
   hidden tank, except where the ghost's lines and dots are. */
TEST_WITH(test_ghosts_change_few_colours, reset, NULL)
{
    view.camera = (struct camera){ .eye_m = { 11, 2.5, 2 }, .target_m = { 0, 0, 1.2 }, .up = { 0, 0, 1 }, .fov_deg = 30 };
    for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++) {
        view.tier = (enum tier)tier;
        view.visibility = (struct visibility){ 0 };
        struct frame *solid = stand_draw(&stand, &view);
        asset_set_add(&view.visibility.ghosts, TANK);
        struct frame *ghost = stand_draw(&stand, &view);
        view.visibility = (struct visibility){ 0 };
        asset_set_add(&view.visibility.hidden, TANK);
        struct frame *hidden = stand_draw(&stand, &view);
        int behind = count_value(hidden, 30), before = count_value(solid, 30), seen = count_value(ghost, 30);
        assert_true(before < 0.7 * behind);
        assert_true(seen > (by_gl ? 0.75 : 0.7) * behind && seen < behind); /* software frames mix fewer colours along edges than GL */
        assert_int_equal(count_value(ghost, 80), 0);
        int changed = count_farther(ghost, hidden, ROUNDING), covered = count_value(solid, 80);
        assert_true(changed > 0.04 * covered && changed < 0.35 * covered);
        assert_int_equal(ghost->marker_count, 8);
        frame_unref(&solid);
        frame_unref(&ghost);
        frame_unref(&hidden);
    }
}

/* A ghosted plane at a grazing angle: depth differs much from pixel to pixel, but the plane must stay transparent and not be
   filled with outlines. */
TEST_WITH(test_a_steep_ghost_is_seen_through, reset, NULL)
{
    view.camera = (struct camera){ .eye_m = { -8, -1, 1.5 }, .target_m = { 0, 0.5, 0 }, .up = { 0, 0, 1 }, .fov_deg = 30 };
    asset_set_add(&view.visibility.isolated, SLAB);
    struct frame *solid = test_frame(stand_draw(&stand, &view));
    asset_set_add(&view.visibility.hidden, SLAB);
    struct frame *hidden = test_frame(stand_draw(&stand, &view));
    view.visibility = (struct visibility){ 0 };
    asset_set_add(&view.visibility.ghosts, SLAB);
    asset_set_add(&view.visibility.isolated, SLAB);
    struct frame *ghost = test_frame(stand_draw(&stand, &view));
    int covered = count_farther(solid, hidden, 8), changed = count_farther(ghost, hidden, 8);
    assert_true(covered > 5000);
    assert_true(changed > 0.02 * covered && changed < 0.2 * covered);
}

TEST_WITH(test_a_ghost_behind_something_is_not_seen, reset, NULL)
{
    view.camera = (struct camera){ .eye_m = { -12, 0, 1.2 }, .target_m = { 0, 0, 1.2 }, .up = { 0, 0, 1 }, .fov_deg = 4 };
    struct frame *solid = test_frame(stand_draw(&stand, &view));
    asset_set_add(&view.visibility.ghosts, PUMP);
    struct frame *ghost = test_frame(stand_draw(&stand, &view));
    assert_int_equal(count_different(solid, ghost), 0);
}

static bool is_neutral(const uint8_t *bgrx)
{
    return abs(bgrx[0] - bgrx[1]) < 12 && abs(bgrx[1] - bgrx[2]) < 12 && bgrx[1] > 60 && bgrx[1] < 120;
}

/* The exchanger lies along x with its axis at y = 0, z = 1.2. The camera in the south sees its inside, because the southern
   half is clipped away. */
TEST_WITH(test_a_cut_opens_a_neutral_inside, reset, NULL)
{
    view.camera = (struct camera){ .eye_m = { 0, -8, 1.2 }, .target_m = { 0, 0, 1.2 }, .up = { 0, 0, 1 }, .fov_deg = 40 };
    for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++)
        for (int look = LOOK_DEFAULT; look <= LOOK_FLAT; look++) {
            view.tier = (enum tier)tier;
            view.look = (enum look)look;
            view.visibility = (struct visibility){ 0 };
            struct frame *whole = stand_draw(&stand, &view);
            assert_false(is_neutral(frame_pixel(whole, 240, 135)));
            view.visibility.clip = (struct clip){ .plane_count = 1, .planes = { { 0, 1, 0, 0 } } };
            struct frame *cut = stand_draw(&stand, &view);
            for (int x = -60; x <= 60; x += 7)
                for (int y = -12; y <= 12; y += 3)
                    assert_true(is_neutral(frame_pixel(cut, 240 + x, 135 + y)));
            int darkest = 255, brightest = 0; /* the exchanger's inside is shaded, so that it looks hollow */
            for (int y = -12; y <= 12; y++) {
                darkest = frame_pixel(cut, 240, 135 + y)[1] < darkest ? frame_pixel(cut, 240, 135 + y)[1] : darkest;
                brightest = frame_pixel(cut, 240, 135 + y)[1] > brightest ? frame_pixel(cut, 240, 135 + y)[1] : brightest;
            }
            assert_true(brightest > darkest + 5);
            assert_int_equal(whole->marker_count, 8);
            /* the other markers of the exchanger were clipped away: two on its top are left, and the tank's three */
            assert_int_equal(cut->marker_count, 5);
            frame_unref(&whole);
            frame_unref(&cut);
        }
}

/* Makes a plant of a box BODY from -1 to 1 and a box CORE inside it, each with a sensor. hollow: BODY has walls 0.2 thick;
   open: one of its triangles is missing. */
static struct toy *nested(bool hollow, bool open)
{
    static const double sensors[2][1][3] = { { { 1, 0, 0 } }, { { 0, 0, 0.5 } } };
    struct toy *toy = toy_create();
    struct test_shape body = { 0 }, core = { 0 };
    shape_box(&body, TOY_STEEL, (double[3]){ -1, -1, -1 }, (double[3]){ 1, 1, 1 });
    if (open)
        body.index_count = body.primitives[0].index_count -= 3;
    if (hollow) {
        size_t first = body.index_count;
        shape_box(&body, TOY_STEEL, (double[3]){ -0.8, -0.8, -0.8 }, (double[3]){ 0.8, 0.8, 0.8 });
        for (size_t i = first; i < body.index_count; i += 3) { /* turns the inner box's triangles inward */
            uint32_t second = body.indices[i + 1];
            body.indices[i + 1] = body.indices[i + 2];
            body.indices[i + 2] = second;
        }
    }
    shape_box(&core, TOY_BLUE, (double[3]){ -0.5, -0.5, -0.5 }, (double[3]){ 0.5, 0.5, 0.5 });
    toy_add(toy, "BODY", &body, (double[3]){ 0 }, sensors[0], 1);
    toy_add(toy, "CORE", &core, (double[3]){ 0 }, sensors[1], 1);
    return toy;
}

/* Draws a section and measures, in the middle row of pixels, where the grey of the cut surface begins (first_m) and ends
   (last_m), in metres to the right of the centre. box: a second plane also cuts off the back, so that rays leave the visible
   part inside the body. */
static void cut_through(struct stand *from, enum tier tier, bool core_cut, bool box, double *first_m, double *last_m, struct pick *pick)
{
    enum { SIDE = 200 };
    struct view at;
    view_default(&from->toy->scene, SIDE, SIDE, &at);
    at.camera = (struct camera){ .eye_m = { 0, -8, 0 }, .target_m = { 0, 0, 0 }, .up = { 0, 0, 1 }, .height_m = 4 };
    at.tier = tier;
    at.look = LOOK_FLAT;
    at.visibility.clip = (struct clip){ .plane_count = 1, .planes = { { 0, 1, 0, core_cut ? 0 : 0.7 } } };
    if (box)
        clip_box(&at.visibility.clip, (double[3]){ -9, core_cut ? 0 : -0.7, -9 }, (double[3]){ 9, core_cut ? 0.4 : 0.7, 9 });
    struct frame *frame = stand_draw(from, &at);
    *first_m = *last_m = NAN;
    for (int x = SIDE / 2; x < SIDE; x++) {
        if (!is_neutral(frame_pixel(frame, x, SIDE / 2)))
            continue;
        *first_m = isnan(*first_m) ? (x - SIDE / 2) / 50.0 : *first_m;
        *last_m = (x + 1 - SIDE / 2) / 50.0;
    }
    pick_at(&from->toy->scene, from->field, &at, from->snapshot, SIDE / 2 + 0.5, SIDE / 2 + 0.5, pick);
    frame_unref(&frame);
}

/* Three bodies, cut open. Solid: a grey cap covers the inside. Hollow: only its walls get caps. Open (a triangle is missing):
   no cap, so the inside is visible. */
TEST_WITH(test_a_cut_closes_bodies, reset, NULL)
{
    double first_m, last_m;
    struct pick pick;
    for (int way = 0; way < 3; way++) {
        struct stand own;
        set_up(&own, nested(way == 1, way == 2));
        toy_set(own.snapshot, 0, 30, QUALITY_GOOD);
        toy_set(own.snapshot, 1, 80, QUALITY_GOOD);
        for (int i = 0; i < 4; i++) {
            enum tier tier = i % 2 ? TIER_REFINED : TIER_PREVIEW;
            bool box = i / 2;
            if (!sweep_takes(by_gl, i + way, 4))
                continue;
            cut_through(&own, tier, false, box, &first_m, &last_m, &pick);
            assert_float_equal(first_m, way == 1 ? 0.8 : way == 2 ? 0.5 : 0, 0.03);
            assert_float_equal(last_m, 1, 0.03);
            assert_int_equal(pick.asset, way == 0 ? 0 : 1);
            assert_int_equal(pick.inside, way == 0);
            assert_float_equal(pick.position_m[1], way == 0 ? -0.701 : -0.5, 1e-6);
            cut_through(&own, tier, true, box, &first_m, &last_m, &pick);
            assert_true(first_m == 0 && pick.inside); /* the asset CORE inside is a closed body of its own, so it gets a cap, too */
        }
        stand_finish(&own);
    }
}

/* A part that is clipped away must not hide what lies behind it, and parts on the other side of the plane must look the same as
   before. */
TEST_WITH(test_a_cut_leaves_the_rest_alone, reset, NULL)
{
    view.visibility.clip = (struct clip){ .plane_count = 1, .planes = { { -1, 0, 0, 50 } } };
    struct frame *uncut = test_frame(stand_draw(&stand, &view));
    view.visibility.clip = (struct clip){ .plane_count = 1, .planes = { { -1, 0, 0, 2.6 } } }; /* this plane removes the tank */
    struct frame *cut = test_frame(stand_draw(&stand, &view));
    assert_true(count_value(uncut, 80) > 2000);
    assert_int_equal(count_value(cut, 80), 0);
    assert_true(count_value(cut, 30) >= count_value(uncut, 30));
    assert_int_equal(cut->marker_count, 5);
    assert_true(cut->triangles < uncut->triangles);
    clip_box(&view.visibility.clip, (double[3]){ 2.9, -9, -9 }, (double[3]){ 9, 9, 9 }); /* only the tank stays */
    struct frame *box = test_frame(stand_draw(&stand, &view));
    assert_int_equal(count_value(box, 30), 0);
    assert_true(count_value(box, 80) >= count_value(uncut, 80));
}

/* Progressive rendering of a section with ghosts gives the same frame. */
TEST_WITH(test_bit_by_bit_is_the_same, reset, NULL)
{
    view.tier = TIER_REFINED;
    asset_set_add(&view.visibility.ghosts, TANK);
    view.visibility.clip = (struct clip){ .plane_count = 1, .planes = { { 0, 1, 0, 0.1 } } };
    struct frame *at_once = test_frame(stand_draw(&stand, &view));
    struct render_job *job = planned_begin(stand.renderer, &view, stand.snapshot);
    while (!renderer_step(stand.renderer, job, 1))
        continue;
    struct frame *bits = test_frame(renderer_end(stand.renderer, &job));
    assert_memory_equal(at_once->bgrx, bits->bgrx, (size_t)bits->stride_bytes * (size_t)bits->height_px);
}

/* In an orthographic view a metre spans the same number of pixels everywhere, and nearer objects still hide farther ones. */
TEST_WITH(test_orthographic_markers_stand_where_they_should, reset, NULL)
{
    view.camera = (struct camera){ .eye_m = { 1.3, -8, 1.2 }, .target_m = { 1.3, 0, 1.2 }, .up = { 0, 0, 1 }, .height_m = 5 };
    double scale = 270 / 5.0;
    for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++) {
        view.tier = (enum tier)tier;
        struct frame *frame = stand_draw(&stand, &view);
        for (size_t i = 0; i < frame->marker_count; i++) {
            const struct frame_marker *marker = &frame->markers[i];
            int tag = marker->tag;
            const struct scene_sensor *sensor =
                tag < 5 ? &stand.toy->scene.assets[EXCHANGER].sensors[tag] : &stand.toy->scene.assets[TANK].sensors[tag - 5];
            assert_float_equal(marker->x_px, 240 + scale * (sensor->surface_m[0] - 1.3), 0.1);
            assert_float_equal(marker->y_px, 135 - scale * (sensor->surface_m[2] - 1.2), 0.1);
        }
        assert_int_equal(frame->markers[0].occluded, 0); /* on the exchanger's southern side */
        assert_true(count_value(frame, 30) > 3000);
        frame_unref(&frame);
        /* in an orthographic view with the eye amid the plant, parts in front of the eye must still be drawn */
        view.camera.eye_m[1] = -0.1;
        frame = stand_draw(&stand, &view);
        assert_int_equal(frame->markers[0].occluded, 0);
        frame_unref(&frame);
        view.camera.eye_m[1] = -8;
    }
}

/* Hidden or clipped assets cast no shadow: when the exchanger is hidden or cut off, the slab under it becomes brighter by at
   least 8 levels. */
TEST_WITH(test_what_is_not_shown_throws_no_shadow, reset, NULL)
{
    view.look = LOOK_DEFAULT;
    view.tier = TIER_REFINED;
    memcpy(view.light_dir, (double[3]){ 0, -0.6, 0.8 }, sizeof(view.light_dir));
    view.camera = (struct camera){ .eye_m = { 0, -1, 9 }, .target_m = { 0, 0.9, 0 }, .up = { 0, 0, 1 }, .height_m = 3 };
    int shaded[3];
    for (int way = 0; way < 3; way++) {
        view.visibility = (struct visibility){ 0 };
        if (way == 1)
            asset_set_add(&view.visibility.hidden, EXCHANGER);
        if (way == 2)
            view.visibility.clip = (struct clip){ .plane_count = 1, .planes = { { 0, 0, -1, 0.5 } } };
        struct frame *frame = stand_draw(&stand, &view);
        shaded[way] = frame_pixel(frame, 132, 100)[1];
        frame_unref(&frame);
    }
    assert_true(shaded[1] > shaded[0] + 8 && shaded[2] > shaded[0] + 8);
    assert_true(abs(shaded[1] - shaded[2]) < 12);
}

/* Sets up a plant of a ball inside a closed room of six walls; `of`: a view of it. */
static void stand_room(struct stand *room, struct view *of)
{
    struct toy *toy = toy_create();
    struct test_shape ball = { 0 }, walls = { 0 };
    shape_sphere(&ball, TOY_CONCRETE, (double[3]){ 0, 0, 0 }, 1, 12);
    shape_box(&walls, TOY_CONCRETE, (double[3]){ -1.2, -1.2, -1.2 }, (double[3]){ 1.2, 1.2, 1.2 });
    toy_add(toy, "BALL", &ball, (double[3]){ 0, 0, 2 }, NULL, 0);
    toy_add(toy, "WALLS", &walls, (double[3]){ 0, 0, 2 }, NULL, 0);
    set_up(room, toy);
    view_default(&toy->scene, 240, 180, of);
    of->tier = TIER_REFINED;
    of->look = LOOK_MATERIALS;
}

/* A ball in a closed room is dark. With hidden walls it must be bright; when the walls are shown again, the picture must be the
   same as before. */
TEST_WITH(test_what_is_hidden_leaves_no_dark, reset, NULL)
{
    struct stand room;
    struct view whole, opened;
    struct frame *first, *again;
    for (int hidden_first = 0; hidden_first <= 1; hidden_first++) {
        stand_room(&room, &whole);
        opened = whole;
        asset_set_add(&opened.visibility.hidden, 1);
        first = hidden_first ? NULL : stand_draw(&room, &whole);
        struct frame *ball = stand_draw(&room, &opened);
        int below = frame_pixel(ball, 120, 90 + 24)[1], middle = frame_pixel(ball, 120, 90)[1];
        assert_true(middle > 110 && below > 60);
        frame_unref(&ball);
        again = stand_draw(&room, &whole);
        if (first)
            assert_int_equal(count_different(first, again), 0);
        int wall = frame_pixel(again, 120, 90)[1];
        print_message("# ball %d, from below %d, wall %d\n", middle, below, wall);
        frame_unref(&first);
        frame_unref(&again);
        stand_finish(&room);
    }
}

int main(void)
{
    if (!rig_init(&rig, "visibility_test"))
        return 0;
    int failed = 0;
    for (int way = 0; way <= 1; way++) {
        by_gl = way == 1;
        set_up(&stand, toy_unit());
        failed += tests_run(by_gl ? "by GL" : "as without a GPU");
        stand_finish(&stand);
    }
    rig_finish(&rig);
    return failed;
}
