/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The values written at markers equal those that the frame shows at the markers' positions. */
#include "tests/support/test.h"

#include "render/frame.h"
#include "render/frame_pool.h"
#include "value/quality.h"

enum { TAGS = 4, WIDTH = 16, HEIGHT = 16 };

static struct snapshot *readings(const double values[TAGS], const uint32_t qualities[TAGS])
{
    struct snapshot *snapshot = snapshot_create(TAGS);
    for (int i = 0; i < TAGS; i++)
        snapshot->readings[i] = (struct reading){ .value = values[i], .quality = qualities[i] };
    return snapshot;
}

/* Makes a frame of a split view in which each tag has one marker in each half. The left half shows what `left` says, the right
   half the readings. */
static struct frame *frame_of_two(enum field_show left, uint32_t baseline)
{
    struct frame *frame = frame_create(NULL, WIDTH, HEIGHT);
    frame->view = (struct view){ .split = true, .field = { .show = left, .baseline = baseline } };
    frame->markers = mem_array(2 * TAGS, sizeof(*frame->markers));
    for (int i = 0; i < 2 * TAGS; i++)
        frame->markers[frame->marker_count++] = (struct frame_marker){ .tag = i % TAGS, .half = i >= TAGS };
    return frame;
}

TEST(test_a_difference_says_differences)
{
    static const double then[TAGS] = { 20, 30, 40, 50 }, now[TAGS] = { 25, 28, 41, 50 };
    static const uint32_t then_q[TAGS] = { 0, 0, QUALITY_BAD_SENSOR_FAILURE, QUALITY_UNCERTAIN_LAST_USABLE }, now_q[TAGS] = { 0 };
    struct baselines *baselines = baselines_create();
    struct snapshot *before = readings(then, then_q), *after = readings(now, now_q);
    uint32_t id = baselines_set(baselines, "then", before);
    struct frame *frame = frame_of_two(SHOW_DIFFERENCE, id);
    frame_read_markers(frame, after, baselines);
    assert_true(frame->markers[0].value == 5 && frame->markers[1].value == -2 && frame->markers[3].value == 0);
    assert_true(quality_is_bad(frame->markers[2].quality) && frame->markers[2].value == 0);
    assert_true(quality_is_uncertain(frame->markers[3].quality));
    for (int i = 0; i < TAGS; i++)
        assert_true(frame->markers[TAGS + i].value == now[i] && frame->markers[TAGS + i].quality == now_q[i]);
    frame_unref(&frame);
    baselines_remove(baselines, "then");
    frame = frame_of_two(SHOW_DIFFERENCE, id);
    frame_read_markers(frame, after, baselines);
    for (int i = 0; i < TAGS; i++)
        assert_true(quality_is_bad(frame->markers[i].quality) && frame->markers[i].value == 0);
    frame_unref(&frame);
    snapshot_destroy(&before);
    snapshot_destroy(&after);
    baselines_destroy(&baselines);
}

TEST(test_readings_and_those_behind_the_eye)
{
    static const double now[TAGS] = { 25, 28, 41, 50 };
    static const uint32_t qualities[TAGS] = { 0, QUALITY_BAD_SENSOR_FAILURE, 0, 0 };
    struct snapshot *snapshot = readings(now, qualities);
    struct frame *frame = frame_of_two(SHOW_VALUE, 0);
    frame->markers[0].x_px = FRAME_BEHIND_PX;
    frame_read_markers(frame, snapshot, NULL);
    assert_int_equal(frame->marker_count, 2 * TAGS - 1);
    assert_true(frame->markers[0].tag == 1 && frame->markers[0].value == 0 && quality_is_bad(frame->markers[0].quality));
    assert_true(frame->markers[1].value == 41);
    frame_unref(&frame);
    snapshot_destroy(&snapshot);
}

/* When the frame shows distances, markers state metres, whatever the unit of the tag. */
TEST(test_distances_stay_what_they_are)
{
    static const double now[TAGS] = { 25, 28, 41, 50 };
    static const uint32_t qualities[TAGS] = { 0, QUALITY_BAD_SENSOR_FAILURE, 0, 0 };
    struct snapshot *snapshot = readings(now, qualities);
    struct frame *frame = frame_of_two(SHOW_DISTANCE, 0);
    for (int i = 0; i < TAGS; i++)
        frame->markers[i].value = 0.5 * i;
    frame_read_markers(frame, snapshot, NULL);
    for (int i = 0; i < TAGS; i++) {
        assert_true(frame->markers[i].value == 0.5 * i && frame->markers[i].quality == qualities[i]);
        assert_true(frame->markers[TAGS + i].value == (qualities[i] ? 0 : now[i]));
    }
    frame_unref(&frame);
    snapshot_destroy(&snapshot);
}

TEST(a_pool_reuses_released_pixels)
{
    struct frame_pool *pool = frame_pool_create();
    struct frame *frame = frame_create(pool, WIDTH, HEIGHT), *other = frame_create(pool, 2 * WIDTH, HEIGHT);
    const uint8_t *pixels = frame->bgrx;
    assert_int_equal(frame_pool_bytes(pool), 3 * WIDTH * HEIGHT * 4);
    frame_unref(&frame);
    assert_int_equal(frame_pool_bytes(pool), 3 * WIDTH * HEIGHT * 4);
    frame = frame_create(pool, WIDTH, HEIGHT);
    assert_ptr_equal(frame->bgrx, pixels);
    frame_unref(&frame);
    frame_pool_drop_spares(pool);
    assert_int_equal(frame_pool_bytes(pool), 2 * WIDTH * HEIGHT * 4);
    frame_pool_unref(&pool); /* the pool is released while a frame from it is still in use, which must stay valid */
    frame_unref(&other);
}
