/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Split views, whose halves have different parameters: each half must equal the frame of its own view, markers and labels stay
   within their half, and drawing in steps gives the same frame as drawing at once. */
#include "tests/support/test.h"

#include "base/clock.h"
#include "render/overlay/overlay.h"
#include "tests/support/planned.h"
#include "tests/support/stand_case.h"
#include "value/quality.h"

enum { WIDTH = 401, HEIGHT = 180, LEFT = 200, DIVIDER_PX = 2 };

static int set_up(void **state)
{
    (void)state;
    stand_init(&stand, &rig, toy_unit());
    for (int i = 0; i < 8; i++)
        toy_set(stand.snapshot, i, 12.0 * i, QUALITY_GOOD);
    return 0;
}

/* Makes a split view: the left half shows the default colours, the right half bands and isolines with another colour map. */
static void make_view(struct view *view)
{
    struct view right;
    view_default(&stand.toy->scene, WIDTH, HEIGHT, view);
    right = *view;
    right.colormap = colormap_find(NULL, "viridis");
    right.look = LOOK_FLAT;
    memcpy(right.color_scale.lines, (double[]){ 20, 40, 60 }, 3 * sizeof(double));
    right.color_scale.line_count = 3;
    view_split(view, &right);
}

static bool same_row(const struct frame *whole, const struct frame *part, int y, int from_px, int part_from_px, int count_px)
{
    return memcmp(frame_pixel(whole, from_px, y), frame_pixel(part, part_from_px, y), (size_t)count_px * 4) == 0;
}

TEST_WITH(test_halves_are_pictures, set_up, stand_tear_down)
{
    struct view view, half;
    make_view(&view);
    for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++) {
        view.tier = (enum tier)tier;
        struct frame *whole = split_view_draw_now(stand.renderer, &view, stand.snapshot), *parts[2];
        assert_true(whole->width_px == WIDTH && whole->height_px == HEIGHT && whole->view.split);
        size_t markers = 0;
        for (int i = 0; i < 2; i++) {
            view_half(&view, i, &half);
            parts[i] = stand_draw(&stand, &half);
            assert_int_equal(parts[i]->width_px, i ? WIDTH - LEFT : LEFT);
            markers += parts[i]->marker_count;
        }
        for (int y = 0; y < HEIGHT; y++) {
            assert_true(same_row(whole, parts[0], y, 0, 0, LEFT - DIVIDER_PX / 2));
            assert_true(same_row(whole, parts[1], y, LEFT + DIVIDER_PX / 2, DIVIDER_PX / 2, WIDTH - LEFT - DIVIDER_PX / 2));
        }
        assert_true(memcmp(parts[0]->bgrx, parts[1]->bgrx, (size_t)LEFT * 4 * HEIGHT) != 0);
        /* the split frame may have fewer markers than the frames of both halves together, because markers that extend into the
           other half are dropped */
        assert_in_range(whole->marker_count, 8, markers);
        for (size_t i = 0; i < whole->marker_count; i++)
            assert_true(whole->markers[i].half == (whole->markers[i].x_px >= LEFT));
        assert_true(whole->label_count > 0 && whole->label_count == parts[1]->label_count);
        for (size_t i = 0; i < whole->label_count; i++)
            assert_true(whole->labels[i].half == 1 && whole->labels[i].x_px == parts[1]->labels[i].x_px + LEFT);
        assert_true(whole->content == planned_content(stand.renderer, &view, stand.snapshot));
        frame_read_markers(whole, stand.snapshot, NULL);
        /* draws markers and both legends; the test only requires that this neither crashes nor hangs */
        overlay_draw(whole, &stand.toy->scene, stand.snapshot, NULL);
        frame_unref(&parts[0]);
        frame_unref(&parts[1]);
        frame_unref(&whole);
    }
}

TEST_WITH(test_bit_by_bit, set_up, stand_tear_down)
{
    struct view view;
    make_view(&view);
    struct split_view *canvas = planned_split(stand.renderer, &view, stand.snapshot, false);
    int steps = 1;
    while (!split_view_step(stand.renderer, canvas, NS_PER_MS))
        steps++;
    assert_true(steps >= 2);
    struct frame *frame = split_view_end(stand.renderer, &canvas), *once = split_view_draw_now(stand.renderer, &view, stand.snapshot);
    assert_null(canvas);
    assert_memory_equal(frame->bgrx, once->bgrx, (size_t)HEIGHT * (size_t)frame->stride_bytes);
    assert_true(frame->content == once->content && frame->marker_count == once->marker_count && frame->label_count == once->label_count);
    frame_unref(&frame);
    frame_unref(&once);
    canvas = planned_split(stand.renderer, &view, stand.snapshot, false);
    split_view_step(stand.renderer, canvas, 1);
    split_view_abandon(stand.renderer, &canvas);
    assert_null(canvas);
}

/* Two split views, both submitted to GL before either is complete, must give the same frames as each drawn alone. */
TEST_WITH(test_launched_together, set_up, stand_tear_down)
{
    struct view views[2];
    struct split_view *canvases[2];
    for (int i = 0; i < 2; i++)
        make_view(&views[i]);
    renderer_use_gl(stand.renderer, true);
    assert_true(renderer_submits(stand.renderer));
    views[1].tier = TIER_REFINED;
    for (int i = 0; i < 2; i++) {
        views[i].camera.eye_m[0] += i;
        canvases[i] = planned_split(stand.renderer, &views[i], stand.snapshot, true);
        assert_non_null(canvases[i]);
    }
    while (!split_view_is_complete(canvases[1])) {
    }
    assert_true(split_view_is_complete(canvases[0]));
    for (int i = 0; i < 2; i++) {
        struct frame *frame = split_view_end(stand.renderer, &canvases[i]),
                     *once = split_view_draw_now(stand.renderer, &views[i], stand.snapshot);
        assert_memory_equal(frame->bgrx, once->bgrx, (size_t)HEIGHT * (size_t)frame->stride_bytes);
        assert_true(frame->content == once->content && frame->marker_count == once->marker_count && frame->label_count > 0);
        assert_memory_equal(frame->markers, once->markers, frame->marker_count * sizeof(*frame->markers));
        frame_unref(&frame);
        frame_unref(&once);
    }
    canvases[0] = planned_split(stand.renderer, &views[0], stand.snapshot, true);
    split_view_abandon(stand.renderer, &canvases[0]);
    renderer_use_gl(stand.renderer, false);
}

/* Each half of a frame of differences has its own baseline. */
TEST_WITH(test_two_baselines, set_up, stand_tear_down)
{
    struct baselines *baselines = baselines_create();
    struct view view, right;
    view_default(&stand.toy->scene, WIDTH, HEIGHT, &view);
    field_set_baselines(stand.field, baselines);
    view.field.show = SHOW_DIFFERENCE;
    view.field.baseline = baselines_set(baselines, "before", stand.snapshot);
    right = view;
    right.field.baseline = baselines_set(baselines, "after", stand.snapshot);
    view_split(&view, &right);
    struct frame *frame = test_frame(split_view_draw_now(stand.renderer, &view, stand.snapshot));
    assert_string_equal(frame->baseline[0].name, "before");
    assert_string_equal(frame->baseline[1].name, "after");
    field_set_baselines(stand.field, NULL);
    baselines_destroy(&baselines);
}

/* Pictures of 16 to 19 pixels width, too narrow for two halves and the divider, must be drawn without a fault. */
TEST_WITH(test_narrow, set_up, stand_tear_down)
{
    struct view view;
    make_view(&view);
    for (view.width_px = 16; view.width_px < 20; view.width_px++) {
        struct frame *frame = split_view_draw_now(stand.renderer, &view, stand.snapshot);
        assert_int_equal(frame->width_px, view.width_px);
        frame_read_markers(frame, stand.snapshot, NULL);
        overlay_draw(frame, &stand.toy->scene, stand.snapshot, NULL);
        frame_unref(&frame);
    }
}

TEST_WITH(test_what_is_not_split_stays_as_it_is, set_up, stand_tear_down)
{
    struct view view;
    view_default(&stand.toy->scene, WIDTH, HEIGHT, &view);
    struct frame *whole = test_frame(split_view_draw_now(stand.renderer, &view, stand.snapshot)), *plain = stand_draw(&stand, &view);
    assert_memory_equal(whole->bgrx, plain->bgrx, (size_t)HEIGHT * (size_t)whole->stride_bytes);
    assert_true(whole->content == plain->content && planned_content(stand.renderer, &view, stand.snapshot) == plain->content);
    struct view split;
    make_view(&split);
    assert_true(planned_content(stand.renderer, &split, stand.snapshot) != plain->content);
    frame_unref(&plain);
}
