/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is drawn over pictures: alarms that no mark shows are listed, those in sight are not; nothing covers what is fitted. */
#include "render/overlay/overlay.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "base/mem.h"
#include "tests/support/toy.h"
#include "value/alarm.h"
#include "value/quality.h"

enum { WIDTH = 1280, HEIGHT = 720 };

static struct {
    struct toy *toy;
    struct snapshot *snapshot;
} stand;

/* A white picture with the mark of one tag in its middle. */
static struct frame *draw(int tag, bool occluded, bool split)
{
    struct frame *frame = frame_create(WIDTH, HEIGHT);
    struct view right;
    view_default(&stand.toy->scene, WIDTH, HEIGHT, &frame->view);
    right = frame->view;
    if (split)
        view_split(&frame->view, &right);
    memset(frame->bgrx, 255, (size_t)frame->stride_bytes * HEIGHT);
    frame->markers = mem_array(1, sizeof(*frame->markers));
    frame->marker_count = 1;
    frame->markers[0] = (struct frame_marker){ .tag = tag, .x_px = 300, .y_px = 200, .occluded = occluded, .value = 1 };
    overlay_draw(frame, &stand.toy->scene, stand.snapshot, NULL);
    return frame;
}

/* Of the left lower corner. */
static bool has_list(const struct frame *frame)
{
    for (int y = HEIGHT * 2 / 3; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH / 4; x++)
            for (int c = 0; c < 3; c++)
                if (frame->bgrx[y * frame->stride_bytes + 4 * x + c] != 255)
                    return true;
    return false;
}

static bool lists(int tag, bool occluded, bool split)
{
    struct frame *frame = draw(tag, occluded, split);
    bool found = has_list(frame);
    frame_unref(&frame);
    return found;
}

static void alarms_out_of_sight_are_listed(void **state)
{
    (void)state;
    struct reading *reading = &stand.snapshot->readings[2];
    for (int split = 0; split < 2; split++) {
        reading->alarm = ALARM_NONE;
        assert_false(lists(2, false, split));
        reading->alarm = ALARM_H;
        reading->alarm_word = ALARM_ACTIVE;
        assert_false(lists(2, false, split));
        assert_true(lists(2, true, split));
        assert_true(lists(1, false, split)); /* its mark is not in the picture at all */
    }
    reading->alarm = ALARM_NONE;
}

static void any_number_of_alarms_fits(void **state)
{
    (void)state;
    for (size_t i = 0; i < stand.snapshot->count; i++)
        stand.snapshot->readings[i].alarm = ALARM_BAD;
    struct frame *frame = draw(0, true, false), *small = frame_create(16, 16);
    assert_true(has_list(frame));
    for (int y = 0; y < HEIGHT / 2; y++) /* no higher than a third of the picture, below the clock */
        assert_true(y < 80 || frame->bgrx[y * frame->stride_bytes + 40] == 255);
    view_default(&stand.toy->scene, 16, 16, &small->view);
    overlay_draw(small, &stand.toy->scene, stand.snapshot, NULL);
    frame_unref(&frame);
    frame_unref(&small);
    for (size_t i = 0; i < stand.snapshot->count; i++)
        stand.snapshot->readings[i].alarm = ALARM_NONE;
}

static void the_window_is_what_is_left_free(void **state)
{
    (void)state;
    struct view view;
    struct camera_window whole, half, none;
    view_default(&stand.toy->scene, WIDTH, HEIGHT, &view);
    overlay_window(&stand.toy->scene, &view, &whole);
    assert_true(whole.left == -1 && whole.bottom == -1 && whole.right > 0.6 && whole.right < 0.85 && whole.top > 0.8 && whole.top < 0.9);
    struct frame *frame = draw(0, false, false);
    for (int y = (int)((1 - whole.top) / 2 * HEIGHT) + 1; y < HEIGHT; y++) /* nothing is drawn there but the mark and its label */
        for (int x = 600; x < (int)((1 + whole.right) / 2 * WIDTH); x++)
            assert_int_equal(frame->bgrx[y * frame->stride_bytes + 4 * x], 255);
    frame_unref(&frame);
    view_split(&view, &(struct view){ .field = view.field, .range_min = view.range_min, .range_max = view.range_max });
    overlay_window(&stand.toy->scene, &view, &half);
    assert_true(half.right < 2 * whole.right - 0.9);
    view_default(&stand.toy->scene, WIDTH, HEIGHT, &view);
    view.look = LOOK_MATERIALS;
    overlay_window(&stand.toy->scene, &view, &none);
    assert_true(none.right == 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(alarms_out_of_sight_are_listed),
        cmocka_unit_test(any_number_of_alarms_fits),
        cmocka_unit_test(the_window_is_what_is_left_free),
    };
    cmocka_set_message_output(CM_OUTPUT_TAP);
    stand.toy = toy_unit();
    stand.snapshot = toy_snapshot(stand.toy);
    toy_fill(stand.snapshot, 0);
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    snapshot_destroy(&stand.snapshot);
    toy_destroy(&stand.toy);
    return failed;
}
