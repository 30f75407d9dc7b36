/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests of the colour maps: their tables of 256 colours, and the distinction of their colours by people with and without
   red-green blindness. */
#include "tests/support/test.h"

#include "plant/colormaps.h"
#include "tests/support/cielab.h"

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
    /* neighbouring colours of a map differ little, which shows that its table is complete and in order */
    for (size_t i = 0; i < colormap_count(NULL); i++)
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
                assert_true(c[k] > -0.004 && c[k] < 1.01); /* tolerance for colours that were rounded to 8 bits */
        }
}

/* Shading must not look like another value. Each colour's lightness L* is changed by up to 7, and the value is read back from
   the legend colour that is nearest to the result. */
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
                    see_without_green(c);
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
    struct plant *plant = test_memory(mem_new(sizeof(*plant)));
    size_t before = colormap_count(plant);
    for (int i = 0; i < 256; i++)
        /* a map in which lightness alone encodes the value, so that only little shading is allowed */
        memcpy(rgb[i], (uint8_t[]){ 20, (uint8_t)i, 20 }, 3);
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
}
