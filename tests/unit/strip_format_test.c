/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Encoding of the strip of pixels in a picture that stores its legend: which members it stores, which errors it corrects, and
   which contents it refuses. */
#include "tests/support/test.h"

#include "protocol/strip_format.h"
#include "tests/support/cad.h"

static const struct strip example = { .min = -12.5f, .max = 480, .show = 2, .group = "temperature", .unit = "°C" };

static void expect_same(const struct strip *a, const struct strip *b)
{
    assert_true(a->min == b->min && a->max == b->max && a->log == b->log && a->show == b->show);
    assert_string_equal(a->group, b->group);
    assert_string_equal(a->unit, b->unit);
}

/* The bytes must never change, because later versions must be able to read the strips of existing pictures. */
TEST(test_bytes)
{
    static const uint8_t head[] = { 1, 4, 0, 0, 0x48, 0xc1, 0, 0, 0xf0, 0x43, 't', 'e', 'm', 'p' };
    uint8_t code[STRIP_BYTES], cells[STRIP_BYTES] = { 0 };
    struct strip strip;
    int mended;
    strip_encode(&example, code);
    assert_memory_equal(code, head, sizeof(head));
    for (int row = 0; row < STRIP_CODE_ROWS; row++)
        for (int column = 0; column < STRIP_INNER; column++)
            strip_set_cell(cells, row, column, strip_cell_dark(code, row, column));
    assert_memory_equal(cells, code, sizeof(code));
    assert_true(strip_decode(code, &strip, &mended));
    assert_int_equal(mended, 0);
    expect_same(&strip, &example);
}

TEST(test_mends_half_of_its_parity)
{
    struct cad_random chance;
    struct strip strip;
    uint8_t code[STRIP_BYTES], spoilt[STRIP_BYTES];
    int mended, refused = 0, rounds = 300;
    cad_random_start(&chance);
    strip_encode(&example, code);
    for (int wrong = 1; wrong <= STRIP_PARITY / 2 + 6; wrong++)
        for (int round = 0; round < rounds; round++) {
            memcpy(spoilt, code, sizeof(code));
            for (int left = wrong; left > 0;) {
                int at = (int)(cad_random(&chance) * STRIP_BYTES);
                uint8_t change = (uint8_t)(1 + cad_random(&chance) * 255);
                if (spoilt[at] != code[at])
                    continue;
                spoilt[at] ^= change;
                left--;
            }
            bool good = strip_decode(spoilt, &strip, &mended);
            if (wrong <= STRIP_PARITY / 2) {
                assert_true(good);
                assert_int_equal(mended, wrong);
                expect_same(&strip, &example);
            } else {
                refused += !good;
            }
        }
    printf("# %d of %d codes beyond mending refused\n", refused, 6 * rounds);
    assert_true(refused == 6 * rounds);
}

TEST(test_long_names_and_nonsense)
{
    uint8_t code[STRIP_BYTES];
    struct strip strip, odd = { .min = 1, .max = 2, .log = true, .group = "" };
    int mended;
    memcpy(odd.group, "temperaturtemperatur12°", 22); /* a name that was cut to 22 bytes within its last character, "°" of two bytes */
    odd.group[21] = "°"[0];
    memcpy(odd.unit, "kJ/(kg K)", 10);
    strip_encode(&odd, code);
    assert_true(strip_decode(code, &strip, &mended));
    assert_true(strip.log);
    assert_string_equal(strip.unit, "kJ/(kg K)");
    odd.max = 1;
    strip_encode(&odd, code);
    assert_false(strip_decode(code, &strip, &mended));
    odd.max = 2, odd.min = 0;
    strip_encode(&odd, code);
    assert_false(strip_decode(code, &strip, &mended)); /* a logarithm of 0 */
    memset(code, 0, sizeof(code));
    assert_false(strip_decode(code, &strip, &mended)); /* all zeros satisfy the error-correcting code, but are no valid strip */
}
