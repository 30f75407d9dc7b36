/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/support/stand_case.h"

#include "render/shaded_colormap.h"
#include "tests/support/test.h"

struct stand stand;

int stand_tear_down(void **state)
{
    (void)state;
    stand_finish(&stand);
    return 0;
}

void stand_expect_hatched(const struct view *view)
{
    struct frame *frame = stand_draw(&stand, view);
    int light = 0, dark = 0, fifth = view->width_px * view->height_px / 5;
    for (int y = 2; y < view->height_px - 2; y++)
        for (int x = 2; x < view->width_px - 2; x++) {
            const uint8_t *pixel = frame_pixel(frame, x, y);
            assert_true(is_grey(pixel));
            light += pixel[0] == colormap_no_data[0][0];
            dark += pixel[0] == colormap_no_data[1][0];
        }
    assert_true(light > fifth && dark > fifth);
    assert_true(frame->oldest_age_ns == INT64_MAX);
    frame_unref(&frame);
}
