/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests of the colour maps as tables and as colours. */
#include "tests/support/test.h"

#include "plant/colormaps.h"

/* --- CIELAB (D65) and deuteranopia (Machado, Oliveira, Fernandes 2009, severity 1) ---------------------------------------- */

static double decode(double s)
{
    return s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4);
}

static double lab_curve(double t)
{
    return t > 216.0 / 24389 ? cbrt(t) : (24389.0 / 27 * t + 16) / 116;
}

static double lab_curve_inverse(double t)
{
    return t > 6.0 / 29 ? t * t * t : 3 * 36.0 / 841 * (t - 4.0 / 29);
}

static void lab_from_linear(const double c[3], double lab[3])
{
    double x = lab_curve((0.4124564 * c[0] + 0.3575761 * c[1] + 0.1804375 * c[2]) / 0.9504700);
    double y = lab_curve(0.2126729 * c[0] + 0.7151522 * c[1] + 0.0721750 * c[2]);
    double z = lab_curve((0.0193339 * c[0] + 0.1191920 * c[1] + 0.9503041 * c[2]) / 1.0888300);
    lab[0] = 116 * y - 16;
    lab[1] = 500 * (x - y);
    lab[2] = 200 * (y - z);
}

static void linear_from_lab(const double lab[3], double c[3])
{
    double fy = (lab[0] + 16) / 116;
    double x = lab_curve_inverse(fy + lab[1] / 500) * 0.95047, y = lab_curve_inverse(fy),
           z = lab_curve_inverse(fy - lab[2] / 200) * 1.08883;
    c[0] = 3.2404542 * x - 1.5371385 * y - 0.4985314 * z;
    c[1] = -0.9692660 * x + 1.8760108 * y + 0.0415560 * z;
    c[2] = 0.0556434 * x - 0.2040259 * y + 1.0572252 * z;
}

static void deuteranope(double c[3])
{
    double r = 0.367322 * c[0] + 0.860646 * c[1] - 0.227968 * c[2], g = 0.280085 * c[0] + 0.672501 * c[1] + 0.047413 * c[2];
    double b = -0.011820 * c[0] + 0.042940 * c[1] + 0.968881 * c[2];
    c[0] = fmin(fmax(r, 0), 1);
    c[1] = fmin(fmax(g, 0), 1);
    c[2] = fmin(fmax(b, 0), 1);
}

static void lab_of(const uint8_t rgb[3], int as_deuteranope, double lab[3])
{
    double c[3];
    for (int k = 0; k < 3; k++)
        c[k] = decode(rgb[k] / 255.0);
    if (as_deuteranope)
        deuteranope(c);
    lab_from_linear(c, lab);
}

static double lab_distance(const double a[3], const double b[3])
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

/* --- tests ---------------------------------------------------------------------------------------------------------------- */

TEST(test_names)
{
    static const char *const names[] = { "relief", "calm", "viridis", "cividis", "diverging", "turbo" };
    assert_int_equal(colormap_count(NULL), 6);
    for (int i = 0; i < 6; i++) {
        assert_int_equal(colormap_find(NULL, names[i]), i);
        assert_string_equal(colormap_at(NULL, (size_t)i)->name, names[i]);
    }
    assert_int_equal(colormap_find(NULL, "jet"), -1);
}

TEST(test_tables_are_whole)
{
    static const uint8_t viridis_first[3] = { 68, 1, 84 }, viridis_last[3] = { 253, 231, 37 }, turbo_last[3] = { 122, 4, 3 };
    assert_memory_equal(colormap_at(NULL, 2)->rgb[0], viridis_first, 3);
    assert_memory_equal(colormap_at(NULL, 2)->rgb[255], viridis_last, 3);
    assert_memory_equal(colormap_at(NULL, 5)->rgb[255], turbo_last, 3);
    for (size_t i = 0; i < colormap_count(NULL); i++) /* a map's rows are complete and in order: neighbouring colours differ little */
        for (int row = 1; row < 256; row++)
            for (int k = 0; k < 3; k++)
                assert_true(abs(colormap_at(NULL, i)->rgb[row][k] - colormap_at(NULL, i)->rgb[row - 1][k]) <= 8);
}

TEST(test_ends_are_not_on_the_map)
{
    for (size_t i = 0; i < colormap_count(NULL); i++) {
        const struct colormap *map = colormap_at(NULL, i);
        double below[3], above[3], at[3];
        lab_of(map->below, 0, below);
        lab_of(map->above, 0, above);
        assert_true(lab_distance(below, above) > 30);
        for (int row = 0; row < 256; row++) {
            lab_of(map->rgb[row], 0, at);
            assert_true(lab_distance(below, at) > 20);
            assert_true(lab_distance(above, at) > 20);
        }
    }
}

TEST(test_maps_for_relief_are_low_in_contrast_and_ordered)
{
    for (int i = 0; i < 4; i++) {
        const struct colormap *map = colormap_at(NULL, (size_t)(i / 2));
        int as_deuteranope = i % 2;
        double before[3], at[3], first[3];
        lab_of(map->rgb[0], as_deuteranope, first);
        lab_of(map->rgb[0], as_deuteranope, before);
        for (int row = 8; row < 256; row += 8) {
            lab_of(map->rgb[row], as_deuteranope, at);
            assert_true(at[0] > 54 && at[0] < 80);
            assert_true(at[0] > before[0]);     /* lighter */
            assert_true(at[2] > before[2] + 1); /* yellower */
            assert_true(lab_distance(at, before) > 2.5);
            memcpy(before, at, sizeof(before));
        }
        assert_true(before[2] - first[2] > 90);
    }
}

TEST(test_maps_for_relief_leave_room_for_shading)
{
    for (int row = 0; row < 512; row++)
        for (int step = -1; step <= 1; step += 2) {
            double lab[3], c[3];
            lab_of(colormap_at(NULL, (size_t)(row / 256))->rgb[row % 256], 0, lab);
            lab[0] += 7 * step;
            linear_from_lab(lab, c);
            for (int k = 0; k < 3; k++)
                assert_true(c[k] > -0.004 && c[k] < 1.01); /* tolerance for the rounding of an 8-bit table */
        }
}

/* Shading must not be mistaken for a value: L* is changed by up to 7, and the value is read back from the nearest legend colour. */
TEST(test_relief_is_read_back_through_shading)
{
    const struct colormap *map = colormap_at(NULL, 0);
    for (int as_deuteranope = 0; as_deuteranope < 2; as_deuteranope++) {
        int misread = 0, total = 0;
        for (int row = 0; row < 256; row += 3)
            for (int shade = -7; shade <= 7; shade++, total++) {
                double lab[3], c[3], seen[3], legend[3], least = 1e9;
                int nearest = 0;
                lab_of(map->rgb[row], 0, lab);
                lab[0] += shade;
                linear_from_lab(lab, c);
                for (int k = 0; k < 3; k++)
                    c[k] = fmin(fmax(c[k], 0), 1);
                if (as_deuteranope)
                    deuteranope(c);
                lab_from_linear(c, seen);
                for (int j = 0; j < 256; j++) {
                    lab_of(map->rgb[j], as_deuteranope, legend);
                    if (lab_distance(seen, legend) < least) {
                        least = lab_distance(seen, legend);
                        nearest = j;
                    }
                }
                misread += abs(nearest - row) > 0.03 * 255;
            }
        assert_true(misread <= total / 20);
    }
}

TEST(test_maps_can_be_added)
{
    uint8_t rgb[256][3];
    struct plant *plant = mem_new(sizeof(*plant));
    size_t before = colormap_count(plant);
    for (int i = 0; i < 256; i++)
        memcpy(rgb[i], (uint8_t[]){ 20, (uint8_t)i, 20 }, 3); /* in this map darkness encodes the value, so shading must be limited */
    assert_true(colormap_add(plant, "mine", (const uint8_t(*)[3])rgb));
    assert_int_equal(colormap_count(plant), before + 1);
    assert_int_equal(colormap_find(plant, "mine"), before);
    assert_int_equal(colormap_find(NULL, "mine"), -1);
    const struct colormap *map = colormap_at(plant, before);
    assert_memory_equal(map->rgb, rgb, sizeof(rgb));
    assert_true(map->shading >= 2 && map->shading < COLORMAP_SHADING);
    for (int i = 0; i < 256; i++)
        assert_true(memcmp(map->below, rgb[i], 3) && memcmp(map->above, rgb[i], 3));
    while (colormap_count(plant) < COLORMAPS_BUILT_IN + PLANT_COLORMAPS)
        assert_true(colormap_add(plant, "other", (const uint8_t(*)[3])rgb));
    assert_false(colormap_add(plant, "one too many", (const uint8_t(*)[3])rgb));
    mem_free(plant);
}
