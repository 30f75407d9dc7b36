/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Conversion of bytes to hexadecimal digits and back. */
#include "base/text/hex.h"

#include "tests/support/test.h"

TEST(every_byte_goes_there_and_back)
{
    uint8_t bytes[256], read[256];
    char text[2 * sizeof(bytes) + 1];
    for (size_t i = 0; i < sizeof(bytes); i++)
        bytes[i] = (uint8_t)i;
    hex_print(bytes, sizeof(bytes), text);
    assert_int_equal(strlen(text), 2 * sizeof(bytes));
    assert_memory_equal(text, "000102030405060708090a0b", 24);
    assert_memory_equal(text + 2 * 0xf0, "f0f1", 4);
    assert_true(hex_read(text, read, sizeof(read)));
    assert_memory_equal(read, bytes, sizeof(bytes));
    hex_print(bytes, 0, text);
    assert_string_equal(text, "");
}

TEST(all_else_is_refused)
{
    uint8_t bytes[2];
    assert_true(hex_read("aBCd", bytes, 2));
    assert_memory_equal(bytes, "\xab\xcd", 2);
    static const char *const wrong[] = { "", "abc", "abcde", "0xab", " abc", "ab-c", "abcg", "+abc", "abc " };
    for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++)
        assert_false(hex_read(wrong[i], bytes, 2));
}
