/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The legend's scale: which position and colour a value has, without and with bands, and on logarithmic scales. */
#include "field/scale.h"
#include "plant/colormaps.h"

#include "tests/support/test.h"

static struct scale linear(double min, double max, double interval)
{
    return (struct scale){ .map = colormap_at(NULL, 0), .min = min, .max = max, .interval = interval };
}

static void expect_row(int row, double value, double min, double max, double interval)
{
    struct scale scale = linear(min, max, interval);
    uint8_t rgb[3];
    assert_int_equal(scale_index(&scale, value), row);
    scale_look_up(&scale, value, rgb);
    assert_memory_equal(rgb, scale.map->rgb[row], 3);
}

TEST(test_continuous)
{
    expect_row(0, 0, 0, 100, 0);
    expect_row(255, 100, 0, 100, 0);
    expect_row(128, 50, 0, 100, 0);
    expect_row(64, -50, -100, 100, 0);
}

TEST(test_outside)
{
    for (size_t i = 0; i < colormap_count(NULL); i++) {
        struct scale scale = linear(0, 100, 10);
        uint8_t rgb[3];
        scale.map = colormap_at(NULL, i);
        scale_look_up(&scale, -0.001, rgb);
        assert_memory_equal(rgb, scale.map->below, 3);
        scale_look_up(&scale, 100.001, rgb);
        assert_memory_equal(rgb, scale.map->above, 3);
        assert_int_equal(scale_index(&scale, 1e30), SCALE_ABOVE);
        assert_int_equal(scale_index(&scale, -1e30), SCALE_BELOW);
    }
}

/* Readings are stored as floats. A reading of exactly MAX may as a float be larger than MAX as a double, and must not count as
   beyond the range. */
TEST(test_limits_are_compared_as_floats)
{
    assert_true((double)0.3f > 0.3);
    expect_row(255, (double)0.3f, 0, 0.3, 0);
    assert_true((double)0.7f < 0.7);
    expect_row(0, (double)0.7f, 0.7, 1, 0);
}

TEST(test_bands_of_an_interval)
{
    expect_row(12, 0, 0, 100, 10); /* the first band is 0..10, with its centre at 5 */
    expect_row(12, 9.99, 0, 100, 10);
    expect_row(38, 10, 0, 100, 10);
    expect_row(243, 99, 0, 100, 10);
    expect_row(243, 100, 0, 100, 10); /* a value of exactly MAX belongs to the last band, not to one beyond */
    expect_row(243, (double)0.3f, 0, 0.3, 0.03);
    /* bands of 19 begin at 0, 19, ... 95; the last one ends at MAX = 100, so its colour is that of 97.5 */
    expect_row(249, 100, 0, 100, 19);
    expect_row(128, 3, 0, 100, 1e6);    /* one band only */
    expect_row(51, -95, -100, 100, 80); /* bands are counted from MIN, not from 0: the first one extends from -100 to -20 */
}

TEST(test_bands_of_breaks)
{
    struct scale scale = linear(0, 100, 10); /* stated breaks between bands take precedence over an interval */
    memcpy(scale.breaks, (double[]){ -5, 60, 80, 95, 100 }, 5 * sizeof(double));
    scale.break_count = 5; /* three of the five breaks lie inside the range, which gives four bands */
    static const struct {
        double value;
        int index;
    } cases[] = { { 0, 32 }, { 59.9, 32 }, { 60, 96 }, { 79.9, 96 }, { 80, 160 }, { 95, 224 }, { 100, 224 } };
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++)
        assert_int_equal(scale_index(&scale, cases[i].value), cases[i].index);
    assert_int_equal(scale_index(&scale, 100.1), SCALE_ABOVE);
    double edges[SCALE_EDGES];
    assert_int_equal(scale_edges(&scale, edges), 3);
    assert_true(edges[0] == 60 && edges[1] == 80 && edges[2] == 95);
}

TEST(test_edges_of_an_interval)
{
    double edges[SCALE_EDGES];
    struct scale scale = linear(20, 70, 20);
    assert_int_equal(scale_edges(&scale, edges), 2);
    assert_true(edges[0] == 40 && edges[1] == 60);
    scale.interval = 25; /* bands of 25 from MIN = 20: the only edge is at 45, since MAX = 70 is none */
    assert_int_equal(scale_edges(&scale, edges), 1);
    scale.interval = 0;
    assert_int_equal(scale_edges(&scale, edges), 0);
    scale.interval = 1e-9; /* more lines than anybody sees */
    assert_int_equal(scale_edges(&scale, edges), 0);
}

TEST(test_logarithmic)
{
    struct scale scale = linear(0.1, 1000, 0);
    scale.log = true;
    assert_int_equal(scale_index(&scale, 0.1), 0);
    assert_int_equal(scale_index(&scale, 1.0001), 64);
    assert_int_equal(scale_index(&scale, 10.001), 128);
    assert_int_equal(scale_index(&scale, 1000), 255);
    assert_int_equal(scale_index(&scale, 0), SCALE_BELOW);
    assert_int_equal(scale_index(&scale, -3), SCALE_BELOW);
    for (double place = 0; place <= 1; place += 0.125)
        assert_true(fabs(scale_place(&scale, scale_value(&scale, place)) - place) < 1e-12);
    assert_true(fabs(scale_value(&scale, 0.5) - 10) < 1e-9);
    /* the step is the smallest difference of values that changes the colour; on a logarithmic scale that is at the low end of
       the range */
    assert_true(scale_step(&scale) < 0.1 * log(1e4) / 255);
    memcpy(scale.breaks, (double[]){ 1, 10 }, 2 * sizeof(double));
    scale.break_count = 2;
    assert_int_equal(scale_index(&scale, 0.9), 42);
    assert_int_equal(scale_index(&scale, 5), 128);
    assert_int_equal(scale_index(&scale, 500), 213);
}
