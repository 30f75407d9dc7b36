/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Colours that are shaded in CIELAB: shading changes only their lightness, by at most the requested amount, and never leaves
   sRGB. */
#include "tests/support/test.h"

#include "plant/colormaps.h"
#include "base/color/lab.h"
#include "tests/support/cielab.h"

TEST(test_only_lightness_changes)
{
    for (size_t m = 0; m < colormap_count(NULL); m++)
        for (int i = 0; i < 256; i += 5)
            for (double offset = -COLORMAP_SHADING; offset <= COLORMAP_SHADING; offset += 1.75) {
                uint8_t shaded[3];
                double was[3], is[3];
                lab_shade(colormap_at(NULL, m)->rgb[i], offset, shaded);
                lab_of(colormap_at(NULL, m)->rgb[i], false, was);
                lab_of(shaded, false, is);
                double change = is[0] - was[0];
                assert_true(fabs(change) <= fabs(offset) + 0.5 && change * offset >= -0.3 * fabs(offset));
                assert_true(hypot(is[1] - was[1], is[2] - was[2]) < 1.6); /* 8 bits round */
            }
}

TEST(test_maps_for_relief_have_room_for_shading)
{
    for (int i = 0; i < 512; i++)
        for (int sign = -1; sign <= 1; sign += 2) {
            const uint8_t *rgb = colormap_at(NULL, (size_t)(i / 256))->rgb[i % 256];
            uint8_t shaded[3];
            double was[3], is[3];
            lab_shade(rgb, sign * COLORMAP_SHADING, shaded);
            lab_of(rgb, false, was);
            lab_of(shaded, false, is);
            assert_true(fabs(is[0] - was[0] - sign * COLORMAP_SHADING) < 0.8);
        }
}

TEST(test_no_shading_leaves_the_color)
{
    static const uint8_t colors[][3] = { { 0, 0, 0 }, { 255, 255, 255 }, { 255, 0, 0 }, { 1, 2, 3 } };
    for (int i = 0; i < 4; i++) {
        uint8_t out[3];
        lab_shade(colors[i], 0, out);
        assert_memory_equal(out, colors[i], 3);
        lab_shade(colors[i], 7, out); /* a colour at the limit of sRGB is shaded only as far as sRGB permits, here not at all */
        assert_true(i != 1 || memcmp(out, colors[i], 3) == 0);
    }
}

/* The amount of shading that each colour map file declares must equal the largest amount that its colours allow. */
TEST(test_shading_and_safety)
{
    for (size_t m = 0; m < colormap_count(NULL); m++) {
        struct colormap judged = *colormap_at(NULL, m);
        colormap_rate_shading(&judged);
        printf("# %s: L* +-%.1f%s\n", judged.name, judged.shading, judged.safe ? ", safe" : "");
        assert_true(judged.shading == colormap_at(NULL, m)->shading && judged.safe == colormap_at(NULL, m)->safe);
    }
    assert_true(colormap_at(NULL, 0)->safe && colormap_at(NULL, 0)->shading == COLORMAP_SHADING);
    assert_true(colormap_operator.shading == COLORMAP_SHADING);
}

TEST(test_maps_that_cannot_be_read_are_not_safe)
{
    struct colormap there_and_back = { .name = "" }, green_to_red = { .name = "" };
    for (int i = 0; i < 256; i++) {
        memset(there_and_back.rgb[i], 2 * (i < 128 ? i : 255 - i), 3);
        memcpy(green_to_red.rgb[i], (uint8_t[]){ (uint8_t)(60 + i / 2), (uint8_t)(140 - i / 3), 60 }, 3); /* about as light all along */
    }
    colormap_rate_shading(&there_and_back);
    assert_true(!there_and_back.safe && there_and_back.shading >= 2);
    colormap_rate_shading(&green_to_red);
    assert_true(!green_to_red.safe && green_to_red.shading >= 2);
}
