/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A field that has the same value everywhere, exactly at the end of the displayed range or at an isoline. Despite rounding, no
   pixel may show an out-of-range colour or an isoline, also on thin triangles seen at a grazing angle. */
#include "tests/support/test.h"

#include "tests/support/rig_case.h"
#include "value/quality.h"

enum { WIDTH_PX = 480, HEIGHT_PX = 320, READING = 90 };

/* Makes thin poles at distances from near the eye to far away, and a ball. */
static struct toy *make_poles(void)
{
    struct toy *toy = toy_create();
    struct test_shape shape = { 0 };
    for (int i = 0; i < 6; i++)
        shape_cylinder(&shape, TOY_STEEL, (double[3]){ 0, 0.5 * i, 0 }, (double[3]){ 9, 0.7 * i, 0.3 * i }, 0.2, 0.05, 1);
    shape_sphere(&shape, TOY_STEEL, (double[3]){ 5, 1, 1.2 }, 0.6, 24);
    toy_add(toy, "POLES", &shape, (double[3]){ 0, 0, 0 }, (double[1][3]){ { 4, 1, 0 } }, 1);
    return toy;
}

static void look_along(const struct stand *stand, enum look look, bool cut, struct view *view)
{
    view_default(&stand->toy->scene, WIDTH_PX, HEIGHT_PX, view);
    view->camera = (struct camera){ .eye_m = { -2, -1.5, 1.5 }, .target_m = { 3, 1, 0.2 }, .up = { 0, 0, 1 }, .fov_deg = 50 };
    view->tier = TIER_REFINED;
    view->look = look;
    if (cut)
        view->visibility.clip = (struct clip){ .plane_count = 1, .planes = { { -1, 0, 0, 6 } } };
}

/* Draws the view with two ranges and returns the number of pixels whose colours differ clearly. lines: with an isoline at the
   reading. */
static int count_changed(struct stand *stand, struct view *view, const double range[2], bool lines, const double other[2])
{
    int changed = 0;
    view->range_min = range[0];
    view->range_max = range[1];
    view->color_scale = (struct color_scale){ .lines = { READING }, .line_count = lines };
    struct frame *one = stand_draw(stand, view);
    view->range_min = other[0];
    view->range_max = other[1];
    view->color_scale = (struct color_scale){ 0 };
    struct frame *two = stand_draw(stand, view);
    for (int y = 0; y < HEIGHT_PX; y++)
        for (int x = 0; x < WIDTH_PX; x++)
            for (int c = 0, far = 0; c < 3 && !far; c++)
                changed += far = abs(frame_pixel(one, x, y)[c] - frame_pixel(two, x, y)[c]) > 12;
    frame_unref(&one);
    frame_unref(&two);
    return changed;
}

/* Frames with the reading exactly at an end of the range must equal those with the reading well inside. Frames with the reading
   slightly outside must equal those with the reading far outside. */
TEST(test_no_specks_at_the_ends)
{
    static const enum look looks[] = { LOOK_DEFAULT, LOOK_GLOSSY, LOOK_FLAT };
    static const double ends[2][2] = { { 20, READING }, { READING, 130 } }, inside[2][2] = { { 20, 90.2 }, { 89.8, 130 } };
    static const double past[2][2] = { { 20, 89.99 }, { 90.01, 130 } }, far_past[2][2] = { { 20, 85 }, { 95, 130 } };
    /* number of pixels that may show the isoline: at grazing angles the rounding errors are as large as the field's slopes */
    enum { LINE_PX = 16 };
    struct stand stand;
    stand_init(&stand, &rig, make_poles());
    renderer_use_gl(stand.renderer, true);
    toy_set(stand.snapshot, 0, READING, QUALITY_GOOD);
    for (int i = 0; i < 12; i++) {
        struct view view;
        int end = i / 6, specks, lines, hidden;
        if (!sweep_takes(end, i + i / 3, 2))
            continue;
        look_along(&stand, looks[i % 3], i / 3 % 2, &view);
        specks = count_changed(&stand, &view, ends[end], false, inside[end]);
        lines = count_changed(&stand, &view, ends[end], true, inside[end]);
        hidden = count_changed(&stand, &view, past[end], false, far_past[end]);
        print_message("# look %d%s, %s: %d specks, %d pixels of lines, %d hidden\n", (int)view.look, i / 3 % 2 ? ", cut" : "",
                      end ? "MIN" : "MAX", specks, lines, hidden);
        assert_int_equal(specks, 0);
        assert_in_range(lines, 0, LINE_PX);
        assert_int_equal(hidden, 0);
    }
    stand_finish(&stand);
}
