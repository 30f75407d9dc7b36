/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Packing of light (three floats per pixel) into 32 bits for the software renderer: unpacking gives each channel to within half
   a step of the largest one. */
#include "tests/support/test.h"

#include "render/soft/tones.h"

static void unpack(uint32_t packed, float light[3])
{
    vec all_of = unpack_light((lanes_int){ 0 } + (int32_t)packed);
    light[0] = all_of.x[0];
    light[1] = all_of.y[0];
    light[2] = all_of.z[0];
}

static void assert_close(const float light[3])
{
    float most = fmaxf(fmaxf(light[0], light[1]), fmaxf(light[2], 0x1p-16f)), back[3];
    unpack(soft_pack_light(light), back);
    for (int c = 0; c < 3; c++)
        assert_true(fabsf(back[c] - light[c]) <= most / 500);
}

TEST(test_light_comes_back)
{
    srandom(5);
    for (int i = 0; i < 100000; i++) {
        float size = ldexpf(1, (int)(random() % 30) - 15), light[3];
        for (int c = 0; c < 3; c++)
            light[c] = size * (float)random() / (float)RAND_MAX;
        assert_close(light);
    }
    for (int e = -14; e <= 15; e++) /* about where the exponent changes */
        for (int step = -4; step <= 4; step++)
            assert_close((float[3]){ ldexpf(1 + (float)step * 0x1p-11f, e), 0, ldexpf(0.3f, e) });
}

TEST(test_what_no_light_is_stays_within_bounds)
{
    float back[3];
    unpack(soft_pack_light((float[3]){ NAN, -1, -INFINITY }), back);
    assert_true(back[0] == 0 && back[1] == 0 && back[2] == 0);
    unpack(soft_pack_light((float[3]){ INFINITY, 1e30f, 0 }), back);
    assert_true(back[0] == 65408 && back[1] == 65408 && back[2] == 0);
}
