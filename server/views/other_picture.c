/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "views/other_picture.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "base/text/utf8.h"

enum { SIGNATURE_BYTES = 8, CHUNK_BYTES = 12 /* CHUNK_BYTES: length, type, checksum */, HEAD_BYTES = 13 };

/* Returns the value of the part whose name is `name`, which includes the equals sign; NULL: there is none. Parts are separated by ", ". */
static const char *value_of(const char *header, const char *name)
{
    const char *at = header;
    while (at && strncmp(at, name, strlen(name)) != 0) {
        at = strstr(at, ", ");
        at = at ? at + 2 : NULL;
    }
    return at ? at + strlen(name) : NULL;
}

static int hex(char c)
{
    const char digits[] = "0123456789abcdef", *at = c ? strchr(digits, c >= 'A' && c <= 'F' ? c + 32 : c) : NULL;
    return at ? (int)(at - digits) : -1;
}

/* Reads a name up to the next comma or blank. Writes "" if the name is too long, is not UTF-8 or has control characters. */
static void read_name(const char *at, char out[OTHER_NAME_BYTES])
{
    size_t count = 0;
    for (; *at && !strchr(", \r\n", *at) && count + 1 < OTHER_NAME_BYTES; at++) {
        int high = *at == '%' ? hex(at[1]) : -1, low = high >= 0 ? hex(at[2]) : -1;
        out[count++] = low >= 0 ? (char)(16 * high + low) : *at;
        at += low >= 0 ? 2 : 0;
    }
    bool good = !*at || strchr(", \r\n", *at);
    out[count] = 0;
    for (size_t i = 0, length; i < count && good; i += length) {
        length = utf8_length(out + i, count - i);
        good = length > 0 && (unsigned char)out[i] >= ' ' && out[i] != 127;
    }
    if (!good)
        out[0] = 0;
}

bool other_picture_read_header(const char *header, struct other_picture *out)
{
    const char *age = value_of(header, "oldest_age_ms="), *name = value_of(header, "plant="), *past = value_of(header, "past=");
    char *end = NULL;
    *out = (struct other_picture){ .oldest_age_ms = -1, .past = past && !strncmp(past, "yes", 3) };
    if (!age || !value_of(header, "data_time_us="))
        return false;
    if (name)
        read_name(name, out->name);
    if (!strncmp(age, "none", 4))
        return true;
    out->oldest_age_ms = strtoll(age, &end, 10);
    return end != age && out->oldest_age_ms >= 0 && out->oldest_age_ms < INT64_MAX / 2;
}

static uint32_t number_at(const uint8_t *at)
{
    return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

bool other_picture_is_png(const uint8_t *bytes, size_t count, int width_px, int height_px)
{
    size_t at = SIGNATURE_BYTES;
    bool first = true, has_data = false;
    if (count < SIGNATURE_BYTES || memcmp(bytes, "\x89PNG\r\n\x1a\n", SIGNATURE_BYTES) != 0)
        return false;
    while (count - at >= CHUNK_BYTES) {
        const uint8_t *chunk = bytes + at, *type = chunk + 4;
        size_t length = number_at(chunk);
        if (length > count - at - CHUNK_BYTES || (uint32_t)crc32(0, type, (uInt)length + 4) != number_at(type + 4 + length))
            return false;
        if (first && (memcmp(type, "IHDR", 4) != 0 || length != HEAD_BYTES || number_at(type + 4) != (uint32_t)width_px ||
                      number_at(type + 8) != (uint32_t)height_px))
            return false;
        first = false;
        has_data |= !memcmp(type, "IDAT", 4);
        at += CHUNK_BYTES + length;
        if (!memcmp(type, "IEND", 4))
            return has_data && at == count;
    }
    return false;
}
