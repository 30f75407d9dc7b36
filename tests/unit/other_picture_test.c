/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parsing of what another plant's server sends: HTTP headers, one of which gives the age of its readings, and PNG files, which
   must be complete. */
#include "views/other_picture.h"

#include "tests/support/test.h"
#include <zlib.h>

#include "base/text/text.h"

TEST(headers_are_read)
{
    struct other_picture about;
    char header[1000];
    assert_true(other_picture_read_header("data_time_us=12, oldest_age_ms=250, plant=Werk%20%C3%84%2C%202", &about));
    assert_int_equal(about.oldest_age_ms, 250);
    assert_string_equal(about.name, "Werk \u00c4, 2");
    assert_true(other_picture_read_header("data_time_us=12, oldest_age_ms=none", &about));
    assert_int_equal(about.oldest_age_ms, -1);
    assert_string_equal(about.name, "");
    assert_true(other_picture_read_header("no_plant=b, an_oldest_age_ms=7, data_time_us=12, oldest_age_ms=250, plant=a", &about));
    assert_int_equal(about.oldest_age_ms, 250);
    assert_string_equal(about.name, "a");
    assert_true(other_picture_read_header("data_time_us=12, oldest_age_ms=250, shows_readings=yes, past=yes", &about) && about.past);
    assert_true(other_picture_read_header("data_time_us=12, oldest_age_ms=250, shows_readings=yes, past=no", &about) && !about.past);
    static const char *const none[] = { "", "oldest_age_ms=1", "data_time_us=1", "data_time_us=1, oldest_age_ms=x",
                                        "data_time_us=1, oldest_age_ms=-5", "data_time_us=1, oldest_age_ms=99999999999999999999999" };
    for (size_t i = 0; i < sizeof(none) / sizeof(none[0]); i++)
        assert_false(other_picture_read_header(none[i], &about));
    static const char *const nameless[] = { "%00", "%0A", "%FF", "%C3", "%7f" };
    for (size_t i = 0; i < sizeof(nameless) / sizeof(nameless[0]); i++) {
        snprintf(header, sizeof(header), "data_time_us=1, oldest_age_ms=1, plant=a%s", nameless[i]);
        assert_true(other_picture_read_header(header, &about));
        assert_string_equal(about.name, "");
    }
    assert_true(other_picture_read_header("data_time_us=1, oldest_age_ms=1, plant=50%", &about));
    assert_string_equal(about.name, "50%");
    int begin = snprintf(header, sizeof(header), "data_time_us=1, oldest_age_ms=1, plant=");
    memset(header + begin, 'x', 500);
    header[begin + 500] = 0;
    assert_true(other_picture_read_header(header, &about));
    assert_string_equal(about.name, "");
    header[begin + OTHER_NAME_BYTES - 1] = 0;
    assert_true(other_picture_read_header(header, &about));
    assert_int_equal(strlen(about.name), OTHER_NAME_BYTES - 1);
}

static void add_number(struct text *out, uint32_t number)
{
    const uint8_t bytes[4] = { (uint8_t)(number >> 24), (uint8_t)(number >> 16), (uint8_t)(number >> 8), (uint8_t)number };
    text_add_bytes(out, bytes, 4);
}

static void add_chunk(struct text *out, const char *type, const void *data, size_t count)
{
    add_number(out, (uint32_t)count);
    size_t begin = out->length;
    text_add_bytes(out, type, 4);
    text_add_bytes(out, data, count);
    add_number(out, (uint32_t)crc32(0, (const uint8_t *)out->at + begin, (uInt)(out->length - begin)));
}

static struct text make_png(void)
{
    static const uint8_t head[13] = { 0, 0, 1, 0, 0, 0, 0, 144, 8, 2 };
    struct text png = { 0 };
    text_add_bytes(&png, "\x89PNG\r\n\x1a\n", 8);
    add_chunk(&png, "IHDR", head, sizeof(head));
    add_chunk(&png, "tEXt", "a\0b", 3);
    add_chunk(&png, "IDAT", "xyz", 3);
    add_chunk(&png, "IEND", "", 0);
    return png;
}

static bool is_png(const struct text *png, size_t count)
{
    uint8_t *own = mem_array(count + 1, 1); /* allocated at the exact size, so that the sanitizer finds a read beyond the end */
    memcpy(own, png->at, count);
    bool good = other_picture_is_png(own, count, 256, 144);
    mem_free(own);
    return good;
}

TEST(png_files_are_whole)
{
    struct text png = make_png();
    assert_true(is_png(&png, png.length));
    assert_false(other_picture_is_png((const uint8_t *)png.at, png.length, 144, 256));
    for (size_t count = 0; count < png.length; count++)
        assert_false(is_png(&png, count));
    for (size_t i = 0; i < png.length; i++) { /* any bit matters */
        png.at[i] = (char)(png.at[i] ^ (1 << (i % 8)));
        assert_false(is_png(&png, png.length));
        png.at[i] = (char)(png.at[i] ^ (1 << (i % 8)));
    }
    text_add_bytes(&png, "x", 1);
    assert_false(is_png(&png, png.length));
    text_finish(&png);
    text_add_bytes(&png, "\x89PNG\r\n\x1a\n", 8);
    add_chunk(&png, "IEND", "", 0);
    assert_false(is_png(&png, png.length));
    text_finish(&png);
}
