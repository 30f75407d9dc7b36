/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The overlay of frames with markers, lists and legend. It must list those alarms whose markers are not visible, and only
   those, and it must not cover the plant when the camera is fitted. */
#include "render/overlay/overlay.h"

#include "tests/support/test.h"

#include <time.h>

#include "base/clock.h"
#include "render/overlay/overlay_pen.h"
#include "render/overlay/overlay_words.h"
#include "tests/support/toy.h"
#include "value/alarm.h"
#include "value/quality.h"

enum { WIDTH = 1280, HEIGHT = 720 };

static struct {
    struct toy *toy;
    struct snapshot *snapshot;
} stand;

/* Returns a white frame with the marker of one tag in the middle, and with the overlay drawn on it. occluded: geometry hides
   the marker. */
static struct frame *draw_view(int tag, bool occluded, const struct view *view)
{
    struct frame *frame = frame_create(NULL, WIDTH, HEIGHT);
    frame->view = *view;
    memset(frame->bgrx, 255, (size_t)frame->stride_bytes * HEIGHT);
    frame->markers = mem_array(1, sizeof(*frame->markers));
    frame->marker_count = 1;
    frame->markers[0] = (struct frame_marker){ .tag = tag, .x_px = 300, .y_px = 200, .occluded = occluded, .value = 1 };
    overlay_draw(frame, &stand.toy->scene, stand.snapshot, NULL);
    return frame;
}

/* Like draw_view(), with the default view. right: parameters of the right half for a split view; NULL: the view is not split.
   */
static struct frame *draw_beside(int tag, bool occluded, const struct view *right)
{
    struct view view;
    view_default(&stand.toy->scene, WIDTH, HEIGHT, &view);
    if (right)
        view_split(&view, right);
    return draw_view(tag, occluded, &view);
}

static struct frame *draw(int tag, bool occluded, bool split)
{
    struct view same;
    view_default(&stand.toy->scene, WIDTH, HEIGHT, &same);
    return draw_beside(tag, occluded, split ? &same : NULL);
}

/* Returns whether the lower left corner of a frame contains the list of alarms without a visible marker. */
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

TEST(alarms_out_of_sight_are_listed)
{
    struct reading *reading = &stand.snapshot->readings[2];
    for (int split = 0; split < 2; split++) {
        reading->alarm = ALARM_NONE;
        assert_false(lists(2, false, split));
        reading->alarm = ALARM_H;
        reading->alarm_status = ALARM_ACTIVE;
        assert_false(lists(2, false, split));
        assert_true(lists(2, true, split));
        assert_true(lists(1, false, split)); /* the marker of tag 1 is outside the frame, so its alarm must be listed in the corner */
    }
    reading->alarm = ALARM_NONE;
}

/* Draws a frame with a hidden marker of tag 2 and a visible marker of tag 0 at (x_px, y_px). Both tags have an alarm. Returns the box of
   the list in the lower left corner. */
static struct label_box list_with(double x_px, double y_px, bool strip)
{
    struct reading *readings = stand.snapshot->readings;
    readings[0].alarm = readings[2].alarm = ALARM_H;
    struct frame *frame = test_frame(frame_create(NULL, WIDTH, HEIGHT));
    view_default(&stand.toy->scene, WIDTH, HEIGHT, &frame->view);
    frame->view.strip = strip;
    memset(frame->bgrx, 255, (size_t)frame->stride_bytes * HEIGHT);
    frame->markers = mem_array(2, sizeof(*frame->markers));
    frame->marker_count = 2;
    frame->markers[0] = (struct frame_marker){ .tag = 2, .x_px = 300, .y_px = 200, .occluded = true };
    frame->markers[1] = (struct frame_marker){ .tag = 0, .x_px = (float)x_px, .y_px = (float)y_px };
    overlay_draw(frame, &stand.toy->scene, stand.snapshot, NULL);
    readings[0].alarm = readings[2].alarm = ALARM_NONE;
    struct label_box list = { .x = 8, .y = HEIGHT };
    for (int y = HEIGHT * 2 / 3; y < HEIGHT - overlay_strip_height(frame); y++)
        if (frame->bgrx[y * frame->stride_bytes + 4 * 16] != 255) {
            list.y = fmin(list.y, y);
            list.height = y + 1 - list.y;
        }
    return list;
}

/* The card of the list hides markers. The list must contain their alarms, too. */
TEST(alarms_under_the_list_are_listed)
{
    struct label_box one = list_with(500, 300, false), two = list_with(60, 690, false);
    assert_true(one.height > 40 && two.height > one.height + 15 && two.height < one.height + 25);
    /* this marker is above a list of one alarm, and under a list of the two alarms */
    struct label_box edge = list_with(150, 654, false);
    assert_true(one.y > 659 && two.y < 659);
    assert_int_equal(edge.height, one.height);
}

/* The legend strip covers the lowest rows of the frame: the list must be above the strip, and must contain the alarms under it. */
TEST(the_strip_hides_no_alarm)
{
    struct label_box one = list_with(500, 300, true), two = list_with(500, 700, true);
    assert_true(one.height > 40 && two.height > one.height + 15);
    assert_true(one.y + one.height < HEIGHT - 70 && two.y + two.height < HEIGHT - 70);
}

TEST(any_number_of_alarms_fits)
{
    for (size_t i = 0; i < stand.snapshot->count; i++)
        stand.snapshot->readings[i].alarm = ALARM_BAD;
    struct frame *frame = test_frame(draw(0, true, false)), *small = frame_create(NULL, 16, 16);
    assert_true(has_list(frame));
    /* the list must not extend into the upper half of the frame; the clock occupies the first 80 rows */
    for (int y = 0; y < HEIGHT / 2; y++)
        assert_true(y < 80 || frame->bgrx[y * frame->stride_bytes + 40] == 255);
    view_default(&stand.toy->scene, 16, 16, &small->view);
    overlay_draw(small, &stand.toy->scene, stand.snapshot, NULL);
    frame_unref(&small);
    for (size_t i = 0; i < stand.snapshot->count; i++)
        stand.snapshot->readings[i].alarm = ALARM_NONE;
}

/* Returns the largest or the smallest blue value in the card of the header, in the dark or the light theme. */
static int extreme(bool dark, bool lightest)
{
    struct view view;
    view_default(&stand.toy->scene, WIDTH, HEIGHT, &view);
    view.dark = dark;
    struct frame *frame = draw_view(2, false, &view);
    int found = lightest ? 0 : 255;
    for (int y = 12; y < 24; y++)
        for (int x = 12; x < 60; x++) {
            int blue = frame->bgrx[y * frame->stride_bytes + 4 * x];
            found = (blue > found) == lightest ? blue : found;
        }
    frame_unref(&frame);
    return found;
}

TEST(cards_are_as_light_or_dark_as_the_backdrop)
{
    assert_true(extreme(false, true) > 250 && extreme(false, false) < 90);
    assert_true(extreme(true, true) > 180 && extreme(true, false) < 90);
}

/* Draws a frame for anonymous viewers with one marker. The result must be the same for every reading and alarm. */
static struct frame *draw_bare(double value, enum alarm_kind alarm)
{
    struct frame *frame = frame_create(NULL, WIDTH, HEIGHT);
    view_default(&stand.toy->scene, WIDTH, HEIGHT, &frame->view);
    memset(frame->bgrx, 255, (size_t)frame->stride_bytes * HEIGHT);
    frame->markers = mem_array(1, sizeof(*frame->markers));
    frame->marker_count = 1;
    frame->markers[0] = (struct frame_marker){ .tag = 2, .x_px = 300, .y_px = 200, .value = (float)value };
    for (size_t i = 1; i < 3; i++) {
        stand.snapshot->readings[i].alarm = (uint8_t)alarm;
        stand.snapshot->readings[i].alarm_status = ALARM_ACTIVE;
    }
    overlay_draw_bare(frame, &stand.toy->scene, stand.snapshot, NULL);
    for (size_t i = 1; i < 3; i++)
        stand.snapshot->readings[i].alarm = ALARM_NONE;
    return frame;
}

TEST(a_bare_one_tells_of_no_sensor)
{
    struct frame *one = test_frame(draw_bare(1, ALARM_NONE)), *other = test_frame(draw_bare(77, ALARM_HH)), *full = draw(2, false, false);
    size_t bytes = (size_t)one->stride_bytes * HEIGHT;
    assert_memory_equal(one->bgrx, other->bgrx, bytes);
    assert_int_not_equal(memcmp(one->bgrx, full->bgrx, bytes), 0);
    assert_false(has_list(other));
    assert_int_equal(one->bgrx[200 * one->stride_bytes + 4 * 300], 255);
    frame_unref(&full);
}

TEST(the_window_is_what_is_left_free)
{
    struct view view;
    struct camera_window whole, half, none;
    view_default(&stand.toy->scene, WIDTH, HEIGHT, &view);
    overlay_window(&stand.toy->scene, &view, &whole);
    assert_true(whole.left == -1 && whole.bottom == -1 && whole.right > 0.6 && whole.right < 0.85 && whole.top > 0.8 && whole.top < 0.9);
    struct frame *frame = test_frame(draw(0, false, false));
    /* from x = 600 on, the window for the plant must be white: the overlay draws only the marker and its label, farther left */
    for (int y = (int)((1 - whole.top) / 2 * HEIGHT) + 1; y < HEIGHT; y++)
        for (int x = 600; x < (int)((1 + whole.right) / 2 * WIDTH); x++)
            assert_int_equal(frame->bgrx[y * frame->stride_bytes + 4 * x], 255);
    view_split(&view, &(struct view){ .field = view.field, .range_min = view.range_min, .range_max = view.range_max });
    overlay_window(&stand.toy->scene, &view, &half);
    assert_true(half.right < 2 * whole.right - 0.9);
    view_default(&stand.toy->scene, WIDTH, HEIGHT, &view);
    view.look = LOOK_MATERIALS;
    overlay_window(&stand.toy->scene, &view, &none);
    assert_true(none.right == 1);
}

/* Returns how many pixels of the frame's middle row the legend covers, counted from the right edge of a half of the split view.
   */
static int legend_px(const struct frame *frame, int half)
{
    int count = 0;
    for (int x = WIDTH / 2 * half + WIDTH * 3 / 8; x < WIDTH / 2 * (half + 1); x++)
        count += frame->bgrx[HEIGHT / 2 * frame->stride_bytes + 4 * x + 1] != 255;
    return count;
}

TEST(halves_share_a_legend_that_says_the_same)
{
    struct view right;
    enum { SAME, DISTANCE, RANGE, MAP, LINES, LOOK, SHOWN, WAYS };
    for (int way = 0; way < WAYS; way++) {
        view_default(&stand.toy->scene, WIDTH, HEIGHT, &right);
        right.field.interpolation = way == DISTANCE ? INTERPOLATION_PAPER : right.field.interpolation;
        right.range_max += way == RANGE ? 10 : 0;
        right.colormap += way == MAP;
        right.color_scale.line_count = way == LINES;
        right.color_scale.lines[0] = 50;
        right.look = way == LOOK ? LOOK_MATERIALS : right.look;
        right.field.show = way == SHOWN ? SHOW_DIFFERENCE : right.field.show;
        struct frame *frame = draw_beside(0, false, &right);
        /* If the halves are equal or differ only in the kind of distance, a colour means the same value in both, so they share
           one legend. */
        bool shared = way == SAME || way == DISTANCE;
        if ((legend_px(frame, 0) > 20) == shared || (legend_px(frame, 1) > 20) != (way != LOOK))
            fail_msg("way %d: %d pixels of the left half, %d of the right", way, legend_px(frame, 0), legend_px(frame, 1));
        frame_unref(&frame);
    }
}

/* Returns how many pixels of the quarter that contains the legend differ between a frame with this look and one with the
   default look. */
static int legend_differs_px(enum look look)
{
    struct view view;
    view_default(&stand.toy->scene, WIDTH, HEIGHT, &view);
    struct frame *plain = draw_view(0, false, &view);
    view.look = look;
    struct frame *other = draw_view(0, false, &view);
    int count = 0;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = WIDTH * 3 / 4; x < WIDTH; x++)
            count += memcmp(plain->bgrx + y * plain->stride_bytes + 4 * x, other->bgrx + y * other->stride_bytes + 4 * x, 3) != 0;
    frame_unref(&plain);
    frame_unref(&other);
    return count;
}

/* Returns the number of pixels in which one half of two frames differs. Releases both frames. */
static int halves_differ_px(int half, struct frame *frames[2])
{
    int count = 0;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = half * WIDTH / 2; x < (half + 1) * WIDTH / 2; x++)
            count += frames[0]->bgrx[y * frames[0]->stride_bytes + 4 * x] != frames[1]->bgrx[y * frames[1]->stride_bytes + 4 * x];
    frame_unref(&frames[0]);
    frame_unref(&frames[1]);
    return count;
}

/* Returns the number of pixels in which a half's legend differs between two split frames whose halves have these errors. */
static int legends_differ_px(int half, const double a[2], const double b[2])
{
    struct frame *frames[2];
    for (int i = 0; i < 2; i++) {
        struct view view;
        view_default(&stand.toy->scene, WIDTH, HEIGHT, &view);
        struct view right = view;
        right.range_max *= 2; /* so that each half has a legend of its own */
        view_split(&view, &right);
        frames[i] = frame_create(NULL, WIDTH, HEIGHT);
        frames[i]->view = view;
        memset(frames[i]->bgrx, 255, (size_t)frames[i]->stride_bytes * HEIGHT);
        memcpy(frames[i]->drawn_error, i ? b : a, sizeof(frames[i]->drawn_error));
        overlay_draw(frames[i], &stand.toy->scene, stand.snapshot, NULL);
    }
    return halves_differ_px(half, frames);
}

/* Returns the number of pixels in which a half's legend differs between two split frames of differences. The halves of the first frame
   subtract no baseline, those of the second the baselines with these names; "": none. */
static int baselines_differ_px(int half, const char *left, const char *right)
{
    struct frame *frames[2];
    for (int i = 0; i < 2; i++) {
        struct view view;
        view_default(&stand.toy->scene, WIDTH, HEIGHT, &view);
        view.field.show = SHOW_DIFFERENCE;
        struct view other = view;
        other.range_max *= 2; /* so that each half has a legend of its own */
        view_split(&view, &other);
        frames[i] = frame_create(NULL, WIDTH, HEIGHT);
        frames[i]->view = view;
        memset(frames[i]->bgrx, 255, (size_t)frames[i]->stride_bytes * HEIGHT);
        const char *names[2] = { left, right };
        for (int k = 0; k < 2 && i == 1; k++) {
            frames[i]->baseline[k].id = names[k][0] ? (uint32_t)k + 1 : 0;
            snprintf(frames[i]->baseline[k].name, sizeof(frames[i]->baseline[k].name), "%s", names[k]);
        }
        overlay_draw(frames[i], &stand.toy->scene, stand.snapshot, NULL);
    }
    return halves_differ_px(half, frames);
}

TEST(each_half_names_its_own_baseline)
{
    assert_true(baselines_differ_px(0, "before the repair", "") > 100);
    assert_int_equal(baselines_differ_px(1, "before the repair", ""), 0);
    assert_true(baselines_differ_px(1, "before the repair", "yesterday") > 100);
    assert_int_equal(baselines_differ_px(0, "", "yesterday"), 0);
}

TEST(each_half_says_its_own_error)
{
    static const double none[2] = { 0, 0 }, left[2] = { 2, 0 }, right[2] = { 0, 2 };
    assert_true(legends_differ_px(0, none, left) > 100);
    assert_int_equal(legends_differ_px(1, none, left), 0);
    assert_true(legends_differ_px(1, none, right) > 100);
    assert_int_equal(legends_differ_px(0, none, right), 0);
}

/* With the glossy look, values that a user reads from colours may be wrong. The legend must say so in two lines. */
TEST(the_legend_says_glossy)
{
    assert_int_equal(legend_differs_px(LOOK_FLAT), 0);
    assert_true(legend_differs_px(LOOK_GLOSSY) > 500);
}

/* Draws two frames, each with one arrow label outside the legend. Returns how many pixels of the legend differ. */
static int arrow_legends_differ_px(const struct frame_label *label, const struct frame_label *other)
{
    const struct frame_label *labels[2] = { label, other };
    struct frame *frames[2];
    for (int i = 0; i < 2; i++) {
        frames[i] = frame_create(NULL, WIDTH, HEIGHT);
        view_default(&stand.toy->scene, WIDTH, HEIGHT, &frames[i]->view);
        frames[i]->view.directions = DIRECTIONS_ARROWS;
        memset(frames[i]->bgrx, 255, (size_t)frames[i]->stride_bytes * HEIGHT);
        frames[i]->labels = mem_array(1, sizeof(*frames[i]->labels));
        frames[i]->label_count = 1;
        frames[i]->labels[0] = *labels[i];
        overlay_draw(frames[i], &stand.toy->scene, stand.snapshot, NULL);
    }
    int count = 0;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = WIDTH * 3 / 4; x < WIDTH; x++)
            count += memcmp(frames[0]->bgrx + y * frames[0]->stride_bytes + 4 * x,
                            frames[1]->bgrx + y * frames[1]->stride_bytes + 4 * x, 3) != 0;
    frame_unref(&frames[0]);
    frame_unref(&frames[1]);
    return count;
}

TEST(the_legend_lists_unknown_directions_where_there_are_any)
{
    const struct frame_label east = { .x_px = 200, .y_px = 200, .value = 50, .arrow = true, .dx = 1 };
    struct frame_label north = east, nowhere = east, still = east;
    north.dx = 0;
    north.dy = 1;
    nowhere.dx = 0;
    still.value = 0; /* a speed of 0 with a known direction, which is drawn as a dot instead of an arrow */
    stand.toy->plant.groups[0].directed = true;
    assert_int_equal(arrow_legends_differ_px(&east, &north), 0);
    assert_int_equal(arrow_legends_differ_px(&east, &still), 0);
    assert_true(arrow_legends_differ_px(&east, &nowhere) > 200);
    stand.toy->plant.groups[0].directed = false;
}

TEST(what_rounds_to_nought_has_no_sign)
{
    assert_true(pen_rounded(-0.04, 1) == 0 && !signbit(pen_rounded(-0.04, 1)) && pen_rounded(0.04, 1) == 0);
    assert_true(pen_rounded(-0.06, 1) == -0.06 && pen_rounded(-0.4, 0) == 0 && pen_rounded(-0.0, 6) == 0);
}

TEST(decimals_follow_the_value_on_a_logarithmic_scale)
{
    struct plant_group group = { .min = 0.1, .max = 1000 };
    assert_int_equal(pen_decimals(&group, 0.45), 0);
    group.log = true;
    assert_int_equal(pen_decimals(&group, 0.45), 4);
    assert_int_equal(pen_decimals(&group, -0.45), 4);
    assert_int_equal(pen_decimals(&group, 0), pen_decimals(&group, 0.1));
    assert_int_equal(pen_decimals(&group, 900), 0);
}

/* Returns the number of pixels that differ between two frames at the upper left corner of one half, where its caption is drawn.
   */
static int caption_px(const struct frame *frame, const struct frame *plain, int half)
{
    int count = 0, left = half ? WIDTH / 2 + 4 : 4;
    for (int y = 4; y < 160; y++)
        for (int x = left; x < left + 240; x++)
            count += frame->bgrx[y * frame->stride_bytes + 4 * x] != plain->bgrx[y * plain->stride_bytes + 4 * x];
    return count;
}

static void differ(struct view *right, int way)
{
    switch (way) {
    case 0: right->field.distance = DISTANCE_EUCLIDEAN; break;
    case 1: right->field.interpolation = INTERPOLATION_PAPER; break;
    case 2: right->field.power = 3.5; break;
    case 3: right->field.strength = 2; break;
    case 4: right->field.decay = 0.5; break;
    case 5: right->field.reach_m = 12; break;
    case 6: right->field.fill = right->field.fill == FILL_NONE ? FILL_NEIGHBOURS : FILL_NONE; break;
    case 7: right->look = LOOK_FLAT; break;
    default: field_params_override(&right->field, (struct field_override){ 0, 2, FIELD_AS_CONFIGURED }); break;
    }
}

/* If the halves of a split view are computed differently, each must have a caption that says how, because legends do not. */
TEST(halves_say_what_they_differ_in)
{
    struct frame *plain = test_frame(draw(0, false, true));
    for (int x = 0; x < 240; x++) /* no caption: both halves of this frame are computed alike */
        assert_int_equal(plain->bgrx[20 * plain->stride_bytes + 4 * (WIDTH / 2 + 4 + x)], 255);
    for (int way = 0; way < 9; way++) {
        struct view right;
        view_default(&stand.toy->scene, WIDTH, HEIGHT, &right);
        differ(&right, way);
        struct frame *frame = draw_beside(0, false, &right);
        for (int half = 0; half < 2; half++)
            if (caption_px(frame, plain, half) < 300)
                fail_msg("way %d, half %d: %d pixels of a caption", way, half, caption_px(frame, plain, half));
        frame_unref(&frame);
    }
}

/* Returns a checksum of the pixels within a rectangle of a frame. */
static unsigned sum_of(const struct frame *frame, const struct label_box *box)
{
    unsigned sum = 0;
    for (int y = (int)box->y; y < (int)(box->y + box->height); y++)
        for (int x = (int)box->x; x < (int)(box->x + box->width); x++)
            sum = sum * 31 + frame->bgrx[y * frame->stride_bytes + 4 * x];
    return sum;
}

/* Returns a checksum of the label of a tag that was lost half an hour before midnight, `minutes` before the readings of the frame. */
static unsigned held_label(int minutes)
{
    struct tm lost = { .tm_year = 126, .tm_mon = 5, .tm_mday = 6, .tm_hour = 23, .tm_min = 30, .tm_isdst = -1 };
    struct reading *reading = &stand.snapshot->readings[2], before = *reading;
    struct snapshot was = *stand.snapshot;
    *reading = (struct reading){ .quality = QUALITY_BAD_COMMUNICATION_ERROR, .alarm = ALARM_H, .alarm_status = ALARM_ACTIVE };
    reading->received_utc_ns = mktime(&lost) * NS_PER_S;
    stand.snapshot->taken_utc_ns = reading->received_utc_ns + minutes * 60 * NS_PER_S;
    struct frame *frame = frame_create(NULL, WIDTH, HEIGHT);
    view_default(&stand.toy->scene, WIDTH, HEIGHT, &frame->view);
    memset(frame->bgrx, 255, (size_t)frame->stride_bytes * HEIGHT);
    frame->markers = mem_array(1, sizeof(*frame->markers));
    frame->marker_count = 1;
    frame->markers[0] = (struct frame_marker){ .tag = 2, .x_px = 400, .y_px = 300, .quality = QUALITY_BAD_COMMUNICATION_ERROR };
    overlay_draw(frame, &stand.toy->scene, stand.snapshot, NULL);
    unsigned sum = sum_of(frame, &(struct label_box){ 200, 220, 600, 160 });
    frame_unref(&frame);
    stand.snapshot->taken_utc_ns = was.taken_utc_ns;
    *reading = before;
    return sum;
}

TEST(the_time_of_a_lost_value_has_its_day_after_midnight)
{
    assert_int_equal(held_label(5), held_label(25));
    assert_int_not_equal(held_label(25), held_label(35));
}

/* Every text of the overlay must change with the language. Each part is compared separately: the header, the captions of both
   halves, the alarm list, the legend, and the note that a frame shows the past. */
TEST(all_speaks_the_language)
{
    static const struct label_box parts[] = {
        { 0, 0, 300, 56 }, { 8, 70, 300, 60 }, { WIDTH / 2 + 8, 10, 300, 60 }, { 0, 500, 300, 220 }, { 1020, 0, 260, HEIGHT }
    };
    enum { PARTS = sizeof(parts) / sizeof(parts[0]) };
    unsigned sums[LANGUAGES][PARTS + 1];
    stand.snapshot->readings[1].alarm = ALARM_H;
    for (int i = 0; i < LANGUAGES; i++) {
        struct view view, right;
        view_default(&stand.toy->scene, WIDTH, HEIGHT, &view);
        view_default(&stand.toy->scene, WIDTH, HEIGHT, &right);
        view.field.interpolation = INTERPOLATION_PAPER;
        right.field.interpolation = INTERPOLATION_GP;
        view_split(&view, &right);
        view.language = (enum language)i;
        struct frame *frame = draw_view(0, false, &view);
        for (int part = 0; part < PARTS; part++)
            sums[i][part] = sum_of(frame, &parts[part]);
        frame_unref(&frame);
        view_default(&stand.toy->scene, WIDTH, HEIGHT, &view);
        view.language = (enum language)i;
        view.at_us = 1;
        frame = draw_view(0, false, &view);
        sums[i][PARTS] = sum_of(frame, &(struct label_box){ 300, 0, 700, 120 });
        frame_unref(&frame);
    }
    stand.snapshot->readings[1].alarm = ALARM_NONE;
    for (int part = 0; part <= PARTS; part++)
        if (sums[0][part] == sums[1][part] || sums[0][part] == sums[2][part] || sums[1][part] == sums[2][part])
            fail_msg("part %d is in one language", part);
}

/* A language in which the legend's title is longer makes the legend wider, so the window for the plant must be smaller. */
TEST(a_longer_legend_takes_more_room)
{
    struct view view; /* shows distances, because the legend then has a sentence as its title */
    struct camera_window english, korean;
    view_default(&stand.toy->scene, WIDTH, HEIGHT, &view);
    view.field.show = SHOW_DISTANCE;
    view.field.sensor = 0;
    overlay_window(&stand.toy->scene, &view, &english);
    view.language = LANGUAGE_KO; /* fewer, though wider characters */
    overlay_window(&stand.toy->scene, &view, &korean);
    assert_true(english.right < korean.right);
}

static int count_places(const char *text)
{
    int count = 0;
    for (; (text = strstr(text, "{}")) != NULL; text += 2)
        count++;
    return count;
}

TEST(each_word_is_in_all_languages)
{
    enum language found;
    for (int word = 0; word < OVERLAY_WORDS; word++) {
        const char *english = overlay_word(LANGUAGE_EN, (enum overlay_word)word);
        for (int i = 0; i < LANGUAGES; i++) {
            const char *text = overlay_word((enum language)i, (enum overlay_word)word);
            if (!text || !text[0] || count_places(text) != count_places(english))
                fail_msg("word %d, language %d: %s", word, i, text ? text : "missing");
        }
    }
    assert_true(overlay_language_find("ko", &found) && found == LANGUAGE_KO);
    assert_false(overlay_language_find("fr", &found));
}

TEST(values_are_put_in)
{
    char text[80], small[8];
    overlay_say(LANGUAGE_EN, WORD_HOT_SPOT_SIZE, "2", "30", text, sizeof(text));
    assert_string_equal(text, "of 2 m, seen as 30 % of the range");
    overlay_say(LANGUAGE_EN, WORD_ALARMS, "12", NULL, text, sizeof(text));
    assert_string_equal(text, "12 alarms");
    overlay_say(LANGUAGE_EN, WORD_FROM, "%s{}%n", NULL, text, sizeof(text));
    assert_string_equal(text, "Distance from %s{}%n");
    overlay_say(LANGUAGE_EN, WORD_HOT_SPOT, "x", NULL, small, sizeof(small));
    assert_string_equal(small, "Detecta");
}

int main(void)
{
    stand.toy = toy_unit();
    stand.snapshot = toy_snapshot(stand.toy);
    toy_fill(stand.snapshot, 0);
    int failed = tests_run(NULL);
    snapshot_destroy(&stand.snapshot);
    toy_destroy(&stand.toy);
    return failed;
}
