/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The cache of recent frames: which of the last frames may answer a request for the same view that follows a moment later. */
#include "service/recent_frames.h"

#include "tests/support/test.h"

#include "base/clock.h"

static const int64_t MS = NS_PER_MS, NOW_NS = 1000 * NS_PER_S;

static struct view view_of(int number)
{
    return (struct view){ .width_px = 64, .height_px = 36, .camera = { .fov_deg = 30 + number } };
}

/* Adds a frame of the view `view_number`, with a content hash, whose readings were taken at read_ns. */
static void draw(struct recent_frames *recent, int view_number, uint64_t content, int64_t read_ns)
{
    struct frame *frame = frame_create(NULL, 64, 36);
    frame->view = view_of(view_number);
    frame->content = content;
    recent_frames_add(recent, frame, read_ns, read_ns);
    frame_unref(&frame);
}

TEST(a_view_is_found_while_nothing_newer_was_said_of_its_readings)
{
    struct recent_frames recent = { 0 };
    struct view view = view_of(1), other = view_of(2);
    draw(&recent, 1, 7, NOW_NS);
    view.camera_seq = 99; /* the client's number of the camera differs, but the view shows the same, so the frame is found */
    assert_true(recent_frames_find_view(&recent, &view, NOW_NS - 50 * MS, NOW_NS + 20 * MS)->content == 7);
    assert_non_null(recent_frames_find_view(&recent, &view, NOW_NS, NOW_NS + 20 * MS));
    assert_null(recent_frames_find_view(&recent, &view, NOW_NS + 10 * MS, NOW_NS + 20 * MS));
    assert_null(recent_frames_find_view(&recent, &other, NOW_NS - 50 * MS, NOW_NS + 20 * MS));
    assert_null(recent_frames_find_view(&recent, &view, NOW_NS - 50 * MS, NOW_NS + NS_PER_S));
    recent_frames_finish(&recent);
}

TEST(the_newest_of_a_view_comes_first_and_few_are_kept)
{
    struct recent_frames recent = { 0 };
    struct view view = view_of(1), gone = view_of(0);
    draw(&recent, 0, 1, NOW_NS);
    for (int i = 0; i < RECENT_FRAMES; i++)
        draw(&recent, 1, (uint64_t)i + 2, NOW_NS + i * MS);
    assert_true(recent_frames_find_view(&recent, &view, 0, NOW_NS + 10 * MS)->content == RECENT_FRAMES + 1);
    assert_true(recent_frames_find(&recent, 3, NOW_NS + 10 * MS)->content == 3);
    assert_null(recent_frames_find_view(&recent, &gone, 0, NOW_NS + 10 * MS));
    assert_null(recent_frames_find(&recent, 1, NOW_NS + 10 * MS));
    recent_frames_finish(&recent);
}
