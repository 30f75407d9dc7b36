/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shading must not be read as value: an exchanger and a tank, read back from the picture by the nearest colour of the legend. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/mem.h"
#include "tests/support/rig.h"
#include "value/quality.h"

enum { WIDTH = 960, HEIGHT = 540 };
static struct rig rig;
static struct stand stand;

static int set_up(void **state)
{
    static const double values[8] = { 4, 30, 55, 80, 97, 12, 45, 88 };
    (void)state;
    stand_init(&stand, &rig, toy_unit());
    for (int i = 0; i < 8; i++)
        toy_set(stand.snapshot, i, values[i], QUALITY_GOOD);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    stand_finish(&stand);
    return 0;
}

static int by_size(const void *a, const void *b)
{
    double d = *(const double *)a - *(const double *)b;
    return (d > 0) - (d < 0);
}

/* 95th percentile of the misreading, in percent of the range. The truth is the map's place in the flat look, without edges. */
static double misread(const struct view *view)
{
    const struct colormap *map = colormap_at((size_t)view->colormap);
    struct view flat = *view;
    flat.look = LOOK_FLAT;
    flat.tier = TIER_MOVING;
    struct frame *truth = stand_draw(&stand, &flat), *shaded = stand_draw(&stand, view);
    double *errors = mem_array(WIDTH * HEIGHT, sizeof(*errors)), p95;
    int count = 0;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            int place = map_index_exact(map, frame_pixel(truth, x, y));
            if (place >= 0)
                errors[count++] = abs(map_index_nearest(map, frame_pixel(shaded, x, y)) - place) / 2.56;
        }
    assert_true(count > WIDTH * HEIGHT / 20);
    qsort(errors, (size_t)count, sizeof(*errors), by_size);
    p95 = errors[count * 95 / 100];
    printf("# %s, tier %d: %d pixels, misread by %.2f %% of the range (p95)\n", map->name, view->tier, count, p95);
    mem_free(errors);
    frame_unref(&truth);
    frame_unref(&shaded);
    return p95;
}

static void test_shading_is_not_read_as_value(void **state)
{
    struct view view;
    (void)state;
    view_default(&stand.toy->scene, WIDTH, HEIGHT, &view);
    for (int map = 0; map < (int)colormap_count(); map++)
        for (int tier = TIER_MOVING; tier <= TIER_STILL; tier++) {
            view.colormap = map;
            view.tier = (enum tier)tier;
            assert_true(misread(&view) <= 3);
        }
}

static void test_glossy_would_be_misread(void **state)
{
    struct view view;
    (void)state;
    view_default(&stand.toy->scene, WIDTH, HEIGHT, &view);
    view.look = LOOK_GLOSSY;
    assert_true(misread(&view) > 3); /* or the test above could not fail */
}

/* Differences between the tiers, seen as lightness: the change from moving to still must not flash. */
static void test_tiers_agree(void **state)
{
    struct view view;
    double sum = 0;
    int count = 0, far = 0;
    (void)state;
    view_default(&stand.toy->scene, WIDTH, HEIGHT, &view);
    view.tier = TIER_STILL;
    struct frame *still = stand_draw(&stand, &view);
    view.tier = TIER_MOVING;
    struct frame *moving = stand_draw(&stand, &view);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++, count++) {
            int difference = frame_pixel(still, x, y)[1] - frame_pixel(moving, x, y)[1];
            sum += difference;
            far += abs(difference) > 24;
        }
    printf("# still - moving: mean %.2f of 255, %.1f %% differ by more than 24\n", sum / count, 100.0 * far / count);
    assert_true(fabs(sum / count) < 2);
    assert_true(far < count * 6 / 100);
    frame_unref(&still);
    frame_unref(&moving);
}

#define each(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        each(test_shading_is_not_read_as_value),
        each(test_glossy_would_be_misread),
        each(test_tiers_agree),
    };
    cmocka_set_message_output(CM_OUTPUT_TAP);
    if (!rig_init(&rig, "shading_test"))
        return 0;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    rig_finish(&rig);
    return failed;
}
