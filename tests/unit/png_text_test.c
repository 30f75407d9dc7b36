/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Texts in PNG files are written and found again; in truncated or damaged files they are not found. */
#include "tests/support/test.h"
#include <png.h>

#include "provenance/png_text.h"

struct png_bytes {
    uint8_t bytes[4096];
    size_t count;
};

static struct png_bytes picture(void)
{
    static const uint8_t pixels[8 * 4 * 3] = { 1, 2, 3 };
    png_image image = { .version = PNG_IMAGE_VERSION, .format = PNG_FORMAT_RGB, .width = 8, .height = 4 };
    struct png_bytes file = { .count = sizeof(file.bytes) };
    assert_true(png_image_write_to_memory(&image, file.bytes, &file.count, 0, pixels, 0, NULL));
    return file;
}

TEST(a_text_is_found_again)
{
    struct png_bytes file = picture();
    char long_text[10000];
    memset(long_text, 'x', sizeof(long_text));
    const struct png_text texts[] = { { "One", "first", 5 }, { "Other", long_text, sizeof(long_text) }, { "Empty", "", 0 } };
    size_t count, length;
    char why[PNG_PLAIN_WHY_BYTES];
    uint8_t *with = test_memory(png_text_add(file.bytes, file.count, texts, 3, &count));
    assert_non_null(with);
    assert_true(count < file.count + 300);
    assert_true(png_is_plain(with, count, (const char *const[]){ "One", "Other", "Empty" }, 3, why));
    assert_false(png_is_plain(with, count, (const char *const[]){ "One", "Other" }, 2, why));
    for (int i = 0; i < 3; i++) {
        char *found = test_memory(png_text_find(with, count, texts[i].keyword, sizeof(long_text), &length));
        assert_non_null(found);
        assert_int_equal(length, texts[i].length);
        assert_memory_equal(found, texts[i].text, length);
    }
    assert_null(png_text_find(with, count, "Oth", 100, &length));
    assert_null(png_text_find(with, count, "Other", sizeof(long_text) - 1, &length));
    png_image image = { .version = PNG_IMAGE_VERSION };
    assert_true(png_image_begin_read_from_memory(&image, with, count));
    png_image_free(&image);
}

TEST(of_two_with_one_keyword_none_is_taken)
{
    struct png_bytes file = picture();
    const struct png_text texts[] = { { "One", "first", 5 }, { "One", "second", 6 } };
    size_t count, length;
    uint8_t *with = test_memory(png_text_add(file.bytes, file.count, texts, 2, &count));
    assert_null(png_text_find(with, count, "One", 100, &length));
}

TEST(what_is_cut_or_damaged_is_refused)
{
    struct png_bytes file = picture();
    const struct png_text text = { "One", "first", 5 };
    size_t count, length;
    char why[PNG_PLAIN_WHY_BYTES];
    uint8_t *with = test_memory(png_text_add(file.bytes, file.count, &text, 1, &count));
    for (size_t i = 0; i < count; i++) {
        uint8_t *cut = mem_array(i, 1);
        if (i)
            memcpy(cut, with, i);
        assert_false(png_is_plain(cut, i, &text.keyword, 1, why));
        mem_free(png_text_find(cut, i, "One", 100, &length));
        mem_free(cut);
        with[i] ^= 0x55;
        assert_false(png_is_plain(with, count, &text.keyword, 1, why));
        with[i] ^= 0x55;
    }
    assert_true(png_is_plain(with, count, &text.keyword, 1, why));
    assert_null(png_text_add((const uint8_t *)"GIF89a", 6, &text, 1, &count));
}
