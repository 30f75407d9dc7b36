/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dirty rectangles: they cover every change, do not overlap, and are few. */
#include "encode/dirty_rects.h"

#include "tests/support/test.h"

static struct frame *grey(int width_px, int height_px)
{
    struct frame *frame = frame_create(NULL, width_px, height_px);
    memset(frame->bgrx, 128, (size_t)height_px * (size_t)frame->stride_bytes);
    return frame;
}

static void dot(struct frame *frame, int x_px, int y_px)
{
    frame->bgrx[(size_t)y_px * (size_t)frame->stride_bytes + (size_t)x_px * 4 + 1] ^= 1;
}

static bool covers(const struct dirty_rect *change, int x_px, int y_px)
{
    return x_px >= change->x_px && x_px < change->x_px + change->width_px && y_px >= change->y_px &&
           y_px < change->y_px + change->height_px;
}

static void check_shape(const struct frame *frame, const struct dirty_rect *rects, int count)
{
    assert_in_range(count, 0, DIRTY_RECTS_MAX);
    for (int i = 0; i < count; i++) {
        const struct dirty_rect *c = &rects[i];
        int right = c->x_px + c->width_px, low = c->y_px + c->height_px;
        assert_true(c->x_px >= 0 && c->y_px >= 0 && c->width_px > 0 && c->height_px > 0 && right <= frame->width_px &&
                    low <= frame->height_px);
        assert_true(c->x_px % DIRTY_RECTS_TILE_PX == 0 && c->y_px % DIRTY_RECTS_TILE_PX == 0);
        assert_true(right % DIRTY_RECTS_TILE_PX == 0 || right == frame->width_px);
        assert_true(low % DIRTY_RECTS_TILE_PX == 0 || low == frame->height_px);
        for (int j = 0; j < i; j++) {
            const struct dirty_rect *d = &rects[j];
            assert_true(c->x_px >= d->x_px + d->width_px || d->x_px >= right || c->y_px >= d->y_px + d->height_px || d->y_px >= low);
        }
    }
}

TEST(equal_pictures_have_none)
{
    struct frame *a = test_frame(grey(333, 77)), *b = test_frame(grey(333, 77));
    struct dirty_rect rects[DIRTY_RECTS_MAX];
    assert_int_equal(dirty_rects_find(a, b, rects), 0);
    assert_true(dirty_rects_none(a, b));
    dot(b, 332, 76);
    assert_false(dirty_rects_none(a, b));
    assert_int_equal(dirty_rects_find(a, b, rects), 1);
    assert_true(rects[0].x_px == 320 && rects[0].y_px == 64 && rects[0].width_px == 13 && rects[0].height_px == 13);
}

TEST(two_far_places_are_two_small_rectangles)
{
    struct frame *a = test_frame(grey(1920, 1080)), *b = test_frame(grey(1920, 1080));
    struct dirty_rect rects[DIRTY_RECTS_MAX];
    dot(b, 5, 5);
    dot(b, 1900, 1070);
    assert_int_equal(dirty_rects_find(a, b, rects), 2);
    check_shape(b, rects, 2);
    assert_true(dirty_rects_share(b, rects, 2) < 0.002);
}

TEST(every_changed_pixel_is_inside)
{
    unsigned seed = (unsigned)sweep_seed();
    srand(seed);
    for (int round = 0; round < 60; round++) {
        int w = 16 + rand() % 700, h = 16 + rand() % 400, dots = 1 + rand() % (round < 30 ? 6 : 400), xs[400], ys[400];
        struct frame *a = grey(w, h), *b = grey(w, h);
        struct dirty_rect rects[DIRTY_RECTS_MAX];
        for (int i = 0; i < dots; i++) {
            xs[i] = rand() % w;
            ys[i] = rand() % h;
            b->bgrx[(size_t)ys[i] * (size_t)b->stride_bytes + (size_t)xs[i] * 4] = 7;
        }
        int count = dirty_rects_find(a, b, rects);
        check_shape(b, rects, count);
        for (int i = 0; i < dots; i++) {
            int inside = 0;
            for (int c = 0; c < count; c++)
                inside += covers(&rects[c], xs[i], ys[i]);
            assert_int_equal(inside, 1);
        }
        frame_unref(&a);
        frame_unref(&b);
    }
}
