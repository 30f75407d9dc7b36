/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests drawn frames. The content hash must change with what is visible, but not with times and frame numbers; markers and the
   age of readings must be right; what is out of sight must not be drawn. Also tests the choice of light, many frame sizes, and
   drawing in small steps. */
#include "tests/support/test.h"

#include "render/memory.h"
#include "tests/support/planned.h"
#include "tests/support/renderer_compare.h"
#include "tests/support/rig.h"
#include "value/quality.h"

static struct rig rig;
static struct stand stand;
static struct view view;

static int reset(void **state)
{
    (void)state;
    for (int i = 0; i < 8; i++)
        toy_set(stand.snapshot, i, 20 + 7 * i, QUALITY_GOOD);
    view_default(&stand.toy->scene, 320, 180, &view);
    view.tier = TIER_PREVIEW;
    return 0;
}

static uint64_t content(void)
{
    return planned_content(stand.renderer, &view, stand.snapshot);
}

TEST_WITH(test_content_is_that_of_the_frame, reset, NULL)
{
    uint64_t before = content();
    struct frame *frame = test_frame(stand_draw(&stand, &view));
    assert_true(frame->content == before && before == content());
}

/* In a split view two frames are planned before the first is drawn: the first plan must stay valid. */
TEST_WITH(test_plan_holds_while_another_is_made, reset, NULL)
{
    view.camera.eye_m[1] += 0.3; /* moves the camera, so that neither frame can reuse what was drawn before */
    struct view other = view;
    struct frame *want = test_frame(stand_draw(&stand, &view));
    other.camera.eye_m[0] += 1;
    other.range_max *= 2;
    struct frame_plan *plan = planned(stand.renderer, &view, stand.snapshot);
    struct frame_plan *next = planned(stand.renderer, &other, stand.snapshot);
    assert_true(plan->content == want->content && next->content != want->content && plan->shape != next->shape);
    struct frame *got = test_frame(renderer_draw(stand.renderer, plan));
    assert_true(got && got->content == want->content);
    assert_memory_equal(got->bgrx, want->bgrx, (size_t)want->stride_bytes * (size_t)want->height_px);
    frame_plan_destroy(&plan);
    frame_plan_destroy(&next);
}

TEST_WITH(test_content_ignores_numbers_and_times, reset, NULL)
{
    uint64_t before = content();
    view.camera_seq = 7;
    view.params_seq = 8;
    view.input_ns = 9;
    stand.snapshot->taken_mono_ns += 1000;
    stand.snapshot->taken_utc_ns += 1000;
    assert_true(content() == before);
}

TEST_WITH(test_content_sees_what_is_drawn, reset, NULL)
{
    uint64_t before = content();
    struct view first = view;
    view.camera.eye_m[0] += 0.01;
    assert_true(content() != before);
    view = first;
    view.tier = TIER_REFINED;
    assert_true(content() != before);
    view = first;
    view.look = LOOK_FLAT;
    assert_true(content() != before);
    view = first;
    view.ramp_interval = 10;
    assert_true(content() != before);
    view = first;
    view.selected_asset = 1;
    assert_true(content() != before);
    view = first;
    view.light_dir[2] *= 0.99;
    assert_true(content() != before);
    view = first;
    assert_true(content() == before);
}

TEST_WITH(test_content_counts_what_can_be_seen, reset, NULL)
{
    double step = 100.0 / 256;
    uint64_t before = content();
    toy_set(stand.snapshot, 2, 34 + 0.3 * step, QUALITY_GOOD);
    assert_true(content() == before);
    toy_set(stand.snapshot, 2, 34 - 0.3 * step, QUALITY_GOOD);
    assert_true(content() == before);
    toy_set(stand.snapshot, 2, 34 + 0.8 * step, QUALITY_GOOD);
    assert_true(content() != before);
    toy_set(stand.snapshot, 2, 34, QUALITY_GOOD);
    assert_true(content() == before);
    toy_set(stand.snapshot, 2, 34, QUALITY_UNCERTAIN_LAST_USABLE);
    assert_true(content() != before);
}

/* Many readings in a row, each of which changes too little to change the frame's content, must together change the content. */
TEST_WITH(test_slow_drift_is_not_lost, reset, NULL)
{
    uint64_t before = content();
    for (int i = 1; i <= 40; i++) {
        toy_set(stand.snapshot, 2, 34 + 0.05 * i, QUALITY_GOOD);
        content();
    }
    assert_true(content() != before);
}

TEST_WITH(test_content_is_the_same_elsewhere, reset, NULL)
{
    struct stand other;
    stand_init(&other, &rig, toy_unit());
    for (int i = 0; i < 8; i++)
        toy_set(other.snapshot, i, 20 + 7 * i, QUALITY_GOOD);
    assert_true(planned_content(other.renderer, &view, other.snapshot) == content());
    struct frame *here = test_frame(stand_draw(&stand, &view)), *there = test_frame(stand_draw(&other, &view));
    assert_memory_equal(here->bgrx, there->bgrx, (size_t)here->stride_bytes * (size_t)here->height_px);
    stand_finish(&other);
}

TEST_WITH(test_what_is_out_of_sight_costs_nothing, reset, NULL)
{
    struct frame *all = test_frame(stand_draw(&stand, &view));
    memcpy(view.camera.target_m, (double[3]){ 4.2, 1.2, 50 }, sizeof(view.camera.target_m));
    memcpy(view.camera.eye_m, (double[3]){ 4.2, -1.2, 20 }, sizeof(view.camera.eye_m));
    struct frame *none = test_frame(stand_draw(&stand, &view));
    assert_true(all->triangles > 20000);
    assert_int_equal(none->triangles, 0);
    uint64_t before = content();
    toy_set(stand.snapshot, 2, 90, QUALITY_GOOD);
    assert_true(content() == before);
}

static void assert_same_picture(const struct frame *a, const struct frame *b)
{
    assert_true(a->content == b->content && a->triangles == b->triangles && a->oldest_age_ns == b->oldest_age_ns);
    assert_memory_equal(a->bgrx, b->bgrx, (size_t)a->stride_bytes * (size_t)a->height_px);
    assert_int_equal(a->marker_count, b->marker_count);
    for (size_t i = 0; i < a->marker_count; i++)
        assert_true(a->markers[i].tag == b->markers[i].tag && a->markers[i].x_px == b->markers[i].x_px &&
                    a->markers[i].y_px == b->markers[i].y_px && a->markers[i].occluded == b->markers[i].occluded);
}

/* Frames that are drawn in steps and must equal the same frame drawn at once. Snapshots may request the preview tier, too. */
static const struct {
    enum tier tier;
    enum look look;
    double ramp_interval;
    int selected_asset;
} bit_cases[] = {
    { TIER_REFINED, LOOK_DEFAULT, 0, -1 },
    { TIER_REFINED, LOOK_GLOSSY, 0, 1 },
    { TIER_REFINED, LOOK_FLAT, 20, -1 },
    { TIER_PREVIEW, LOOK_DEFAULT, 0, -1 },
};

/* While a frame is drawn in steps, other views are drawn, readings change, and the frame's light is evicted from the cache. */
TEST_WITH(test_bit_by_bit_is_the_same_picture, reset, NULL)
{
    view.width_px = 801;
    view.height_px = 601;
    size_t cases = sizeof(bit_cases) / sizeof(bit_cases[0]);
    for (size_t n = 0; n < 2 * cases; n++) {
        size_t i = n % cases;
        bool by_gl = n >= cases;
        if (!sweep_takes(by_gl, (int)i, 2))
            continue;
        view.tier = bit_cases[i].tier;
        view.look = bit_cases[i].look;
        view.ramp_interval = bit_cases[i].ramp_interval;
        view.selected_asset = bit_cases[i].selected_asset;
        toy_set(stand.snapshot, 2, 34, QUALITY_GOOD);
        renderer_use_gl(stand.renderer, by_gl);
        struct frame *whole = stand_draw(&stand, &view);
        struct render_job *job = planned_begin(stand.renderer, &view, stand.snapshot);
        int steps = 1;
        assert_non_null(job);
        for (; !renderer_step(stand.renderer, job, 0); steps++) {
            struct view other = view;
            if (steps % 4)
                continue;
            other.tier = steps % 8 ? TIER_PREVIEW : TIER_REFINED;
            other.camera.eye_m[steps % 3] *= 1.1;
            other.light_dir[2] = 0.3 + 0.02 * (steps % 5);
            toy_set(stand.snapshot, 2, 40 + steps, QUALITY_GOOD);
            struct frame *frame = stand_draw(&stand, &other);
            frame_unref(&frame);
        }
        /* in software a frame takes many steps; a GPU may draw it in one */
        assert_true(steps >= (rig.gl->software && (by_gl || view.tier == TIER_REFINED) ? 12 : 1));
        struct frame *bits = renderer_end(stand.renderer, &job);
        assert_true(bits && !job);
        assert_same_picture(whole, bits);
        frame_unref(&whole);
        frame_unref(&bits);
    }
    renderer_use_gl(stand.renderer, false);
}

TEST_WITH(test_abandoned_picture_leaves_no_trace, reset, NULL)
{
    view.tier = TIER_REFINED;
    struct frame *before = test_frame(stand_draw(&stand, &view));
    for (int i = 0; i < 20; i++) {
        struct render_job *job = planned_begin(stand.renderer, &view, stand.snapshot);
        assert_non_null(job);
        for (int step = 0; step < i % 3; step++)
            renderer_step(stand.renderer, job, 0);
        renderer_abandon(stand.renderer, &job);
        assert_null(job);
    }
    struct frame *after = test_frame(stand_draw(&stand, &view));
    assert_same_picture(before, after);
}

/* Returns the marker of tag 5, the tank's first sensor, which is at (3.5, 0.5, 0.6) and faces south-west; NULL if there is
   none. */
static const struct frame_marker *tank_marker(struct frame *frame)
{
    for (size_t i = 0; i < frame->marker_count; i++)
        if (frame->markers[i].tag == 5)
            return &frame->markers[i];
    return NULL;
}

static void look(double ex, double ey, double ez, double tx, double ty, double tz)
{
    view.camera = (struct camera){ .eye_m = { ex, ey, ez }, .target_m = { tx, ty, tz }, .up = { 0, 0, 1 }, .fov_deg = 45 };
}

TEST_WITH(test_markers, reset, NULL)
{
    const double *at = stand.toy->scene.assets[1].sensors[0].surface_m;
    for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++) {
        view.tier = (enum tier)tier;
        look(at[0] - 2, at[1] - 2, at[2], at[0], at[1], at[2]);
        struct frame *frame = stand_draw(&stand, &view);
        const struct frame_marker *marker = tank_marker(frame);
        assert_int_equal(frame->marker_count, 8);
        assert_true(fabs(marker->x_px - 160) < 0.6 && fabs(marker->y_px - 90) < 0.6);
        assert_false(marker->occluded);
        frame_unref(&frame);
        look(at[0] + 5, at[1] + 5, at[2], at[0], at[1], at[2]);
        frame = stand_draw(&stand, &view);
        assert_true(tank_marker(frame)->occluded);
        assert_true(fabs(tank_marker(frame)->x_px - 160) < 0.6);
        frame_unref(&frame);
        look(at[0] - 2, at[1] - 2, at[2], at[0] - 4, at[1] - 4, at[2]);
        frame = stand_draw(&stand, &view);
        assert_true(tank_marker(frame)->occluded);
        frame_unref(&frame);
    }
}

/* With a vertical angle of 45 degrees, a point 1 m above the target at a distance of 1 m / tan(22.5) lies on the upper edge. */
TEST_WITH(test_marker_upward_is_upward, reset, NULL)
{
    const double *at = stand.toy->scene.assets[1].sensors[0].surface_m;
    look(at[0] - 2, at[1] - 2, at[2] - 0.5, at[0], at[1], at[2] - 0.5);
    struct frame *frame = test_frame(stand_draw(&stand, &view));
    double expected = 90 - 0.5 / (sqrt(8) * tan(22.5 * M_PI / 180)) * 90;
    assert_true(fabs(tank_marker(frame)->y_px - expected) < 0.6);
}

TEST_WITH(test_age_of_the_oldest, reset, NULL)
{
    stand.snapshot->readings[3].age_ns = 42;
    for (int i = 0; i < 8; i++)
        stand.snapshot->readings[i].age_ns = i == 3 ? 9000000000 : 1000000000;
    struct frame *frame = stand_draw(&stand, &view);
    assert_true(frame->oldest_age_ns == 9000000000);
    frame_unref(&frame);
    for (int i = 0; i < 8; i++)
        toy_set(stand.snapshot, i, 0, QUALITY_BAD_COMMUNICATION_ERROR);
    frame = stand_draw(&stand, &view);
    assert_true(frame->oldest_age_ns == INT64_MAX);
    frame_unref(&frame);
}

static long brightness(const struct frame *frame)
{
    long sum = 0;
    for (int y = 0; y < frame->height_px; y++)
        for (int x = 0; x < frame->width_px; x++)
            sum += frame_pixel(frame, x, y)[1];
    return sum;
}

/* Requests five lights in turn, more than fit into the cache, then again: each must give the same frame as the first time,
   although it was evicted meanwhile. */
TEST_WITH(test_light_can_be_chosen, reset, NULL)
{
    long first[5];
    for (int round = 0; round < 2; round++)
        for (int i = 0; i < 5; i++) {
            double turn = 1.2 * i, height = 0.5;
            memcpy(view.light_dir, (double[3]){ sqrt(1 - height * height) * cos(turn), sqrt(1 - height * height) * sin(turn), height },
                   sizeof(view.light_dir));
            struct frame *frame = stand_draw(&stand, &view);
            if (round == 0)
                first[i] = brightness(frame);
            assert_int_equal(brightness(frame), first[i]);
            assert_true(i == 0 || first[i] != first[i - 1]);
            frame_unref(&frame);
        }
}

/* The default light does not depend on the window's size: otherwise each size would need a light of its own to be baked. */
TEST_WITH(test_default_light_is_one, reset, NULL)
{
    struct view wide, tall;
    view_default(&stand.toy->scene, 1600, 400, &wide);
    view_default(&stand.toy->scene, 300, 900, &tall);
    assert_memory_equal(wide.light_dir, tall.light_dir, sizeof(wide.light_dir));
}

TEST_WITH(test_selection_is_outlined, reset, NULL)
{
    for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++) {
        view.tier = (enum tier)tier;
        view.selected_asset = -1;
        struct frame *plain = stand_draw(&stand, &view);
        view.selected_asset = 1;
        struct frame *outlined = stand_draw(&stand, &view);
        int changed = 0;
        for (int y = 0; y < 180; y++)
            for (int x = 0; x < 320; x++)
                changed += memcmp(frame_pixel(plain, x, y), frame_pixel(outlined, x, y), 3) != 0;
        assert_in_range(changed, 200, 3000);
        frame_unref(&plain);
        frame_unref(&outlined);
    }
}

TEST_WITH(test_many_sizes, reset, NULL)
{
    static const int sizes[][2] = { { 16, 16 },   { 640, 360 }, { 16, 1200 }, { 1201, 17 },
                                    { 333, 211 }, { 640, 360 }, { 800, 600 }, { 801, 601 } };
    for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++)
        for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++) {
            view.width_px = sizes[i][0];
            view.height_px = sizes[i][1];
            view.tier = (enum tier)tier;
            struct frame *frame = stand_draw(&stand, &view);
            assert_true(frame->width_px == sizes[i][0] && frame->height_px == sizes[i][1] && brightness(frame) > 0);
            frame_unref(&frame);
        }
}

TEST_WITH(test_camera_within_the_plant, reset, NULL)
{
    look(0, 0, 1.2, 1, 0, 1.2); /* the camera is inside the body of the exchanger */
    struct frame *frame = stand_draw(&stand, &view);
    assert_true(brightness(frame) > 0);
    frame_unref(&frame);
    look(2, -3, -4, 2, 0, 1); /* the camera is under the ground */
    frame = stand_draw(&stand, &view);
    assert_true(brightness(frame) > 0);
    frame_unref(&frame);
}

/* Draws frames of several views, looks, lights and sizes, to fill all caches of a renderer. */
static void draw_much(void)
{
    static const int sizes[][2] = { { 320, 180 }, { 640, 360 }, { 400, 300 } };
    for (int i = 0; i < 18; i++) {
        stand_look(&stand, i, &view);
        view.width_px = sizes[i % 3][0];
        view.height_px = sizes[i % 3][1];
        view.tier = i % 2 ? TIER_REFINED : TIER_PREVIEW;
        view.look = i % 5 == 4 ? LOOK_MATERIALS : i % 5 == 3 ? LOOK_GLOSSY : LOOK_DEFAULT;
        renderer_use_gl(stand.renderer, i % 5 == 3); /* every fifth frame is drawn with GL, the others in software */
        view.light_dir[0] = i % 4 == 3 ? 0.6 : 0;
        view.light_dir[1] = 0;
        view.light_dir[2] = i % 4 == 3 ? 0.8 : 1;
        struct frame *frame = stand_draw(&stand, &view);
        frame_unref(&frame);
    }
    renderer_use_gl(stand.renderer, false);
}

static size_t caches(void)
{
    size_t bytes[RENDER_STORES], sum = 0;
    renderer_measure_memory(stand.renderer, bytes);
    for (int i = 0; i < RENDER_STORES; i++)
        sum += i == STORE_MODELS ? 0 : bytes[i];
    return sum;
}

TEST_WITH(test_what_is_kept_can_be_had_anew, reset, NULL)
{
    struct view seen = view;
    stand_look(&stand, 1, &seen);
    seen.tier = TIER_REFINED;
    /* incremental updates by earlier tests have left rounding errors in the field's sums: begins with empty caches */
    renderer_drop_caches(stand.renderer);
    field_clear_cache(stand.field);
    struct frame *before = test_frame(stand_draw(&stand, &seen));
    draw_much();
    size_t full = caches();
    renderer_drop_caches(stand.renderer);
    field_clear_cache(stand.field);
    assert_int_equal(field_bytes(stand.field), 0);
    size_t bytes[RENDER_STORES];
    renderer_measure_memory(stand.renderer, bytes);
    assert_true(bytes[STORE_MODELS] > 0 && bytes[STORE_FIELDS] == 0 && bytes[STORE_PICTURES] == 0 && bytes[STORE_TARGETS] == 0 &&
                bytes[STORE_ROOM] == 0);
    assert_true(caches() < full);
    struct frame *after = test_frame(stand_draw(&stand, &seen));
    assert_true(before->content == after->content);
    assert_memory_equal(before->bgrx, after->bgrx, (size_t)before->stride_bytes * (size_t)before->height_px);
}

/* The memory of the renderer's caches is bounded. Lighting is excluded: two sets always exist, one displayed and one being baked. */
TEST_WITH(test_what_is_kept_has_a_bound, reset, NULL)
{
    size_t full[RENDER_STORES], bytes[RENDER_STORES], bound = (size_t)1 << 20;
    draw_much();
    renderer_measure_memory(stand.renderer, full);
    renderer_bound_memory(stand.renderer, bound);
    draw_much();
    renderer_bound_memory(stand.renderer, bound);
    renderer_measure_memory(stand.renderer, bytes);
    /* only the software renderer keeps visibility buffers and targets of earlier views */
    if (stand.rig->gl->software) {
        assert_true(full[STORE_PICTURES] > bound && full[STORE_TARGETS] > 0);
        assert_true(bytes[STORE_TARGETS] < full[STORE_TARGETS]);
    }
    assert_true(bytes[STORE_PICTURES] <= bound);
    assert_true(bytes[STORE_LIGHT] <= full[STORE_LIGHT] && bytes[STORE_ROOM] <= full[STORE_ROOM]);
    renderer_bound_memory(stand.renderer, (size_t)1 << 30);
}

int main(void)
{
    if (!rig_init(&rig, "renderer_test"))
        return 0;
    stand_init(&stand, &rig, toy_unit());
    int failed = tests_run(NULL);
    stand_finish(&stand);
    rig_finish(&rig);
    return failed;
}
