/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A byte order mark decides, then validity as UTF-8, then whether high bytes come in the pairs of Korean syllables. */
#include "preprocess/match/charset.h"

#include <errno.h>
#include <iconv.h>
#include <stdbool.h>
#include <string.h>

#include "base/text.h"
#include "base/utf8.h"

static const char replacement[] = "\xef\xbf\xbd";

static bool is_utf8(const char *bytes, size_t count)
{
    for (size_t i = 0; i < count;) {
        size_t length = bytes[i] == 0 ? 1 : utf8_length(bytes + i, count - i);
        if (length == 0)
            return false;
        i += length;
    }
    return true;
}

/* Text of Western letters in UTF-16 has a zero in every second byte. */
static const char *find_utf16(const unsigned char *bytes, size_t count)
{
    size_t even = 0, odd = 0, pairs = (count < 4096 ? count : 4096) / 2;
    for (size_t i = 0; i < pairs; i++) {
        even += bytes[2 * i] == 0;
        odd += bytes[2 * i + 1] == 0;
    }
    if (pairs < 2)
        return NULL;
    return odd * 2 > pairs && even == 0 ? "UTF-16LE" : even * 2 > pairs && odd == 0 ? "UTF-16BE" : NULL;
}

/* KS X 1001: both bytes of a syllable are 0xA1 or more; letters of cp1252 mostly stand alone among ASCII. */
static bool is_korean(const unsigned char *bytes, size_t count)
{
    size_t high = 0, paired = 0;
    for (size_t i = 0; i < count; i++) {
        if (bytes[i] < 0x80)
            continue;
        high++;
        if (bytes[i] >= 0xa1 && bytes[i] <= 0xfd && i + 1 < count && bytes[i + 1] >= 0xa1 && bytes[i + 1] <= 0xfe) {
            high++;
            paired += 2;
            i++;
        }
    }
    return high > 0 && (double)paired >= 0.9 * (double)high;
}

/* What has no meaning becomes U+FFFD, one for each byte. Bytes 0 are left out. */
static void convert(const char *bytes, size_t count, const char *iconv_name, struct charset_text *out)
{
    struct text text = { 0 };
    char buffer[4096], *from = (char *)bytes;
    size_t left = count;
    iconv_t converter = iconv_open("UTF-8", iconv_name);
    while (left > 0) {
        char *to = buffer;
        size_t room = sizeof(buffer);
        size_t status = converter == (iconv_t)-1 ? (size_t)-1 : iconv(converter, &from, &left, &to, &room);
        int error = converter == (iconv_t)-1 ? EILSEQ : errno;
        for (const char *at = buffer; at < to; at++)
            if (*at)
                text_add_bytes(&text, at, 1);
            else
                out->damaged++;
        if (status == (size_t)-1 && error != E2BIG) {
            text_add_bytes(&text, replacement, sizeof(replacement) - 1);
            out->damaged++;
            from++;
            left--;
        }
    }
    if (converter != (iconv_t)-1)
        iconv_close(converter);
    text_add_bytes(&text, "", 0);
    out->utf8 = text.at;
    out->length = text.length;
}

void charset_decode(const char *bytes, size_t count, struct charset_text *out)
{
    const unsigned char *unsigned_bytes = (const unsigned char *)bytes;
    const char *utf16 = count >= 2 && !memcmp(bytes, "\xff\xfe", 2)   ? "UTF-16LE"
                        : count >= 2 && !memcmp(bytes, "\xfe\xff", 2) ? "UTF-16BE"
                                                                      : NULL;
    size_t mark = utf16 ? 2 : count >= 3 && !memcmp(bytes, "\xef\xbb\xbf", 3) ? 3 : 0;
    *out = (struct charset_text){ .encoding = utf16 };
    if (!utf16 && mark == 0)
        utf16 = out->encoding = find_utf16(unsigned_bytes, count);
    if (!out->encoding)
        out->encoding = is_utf8(bytes, count) ? "UTF-8" : mark == 3 ? "UTF-8" : is_korean(unsigned_bytes, count) ? "cp949" : "cp1252";
    convert(bytes + mark, count - mark,
            !strcmp(out->encoding, "cp949")    ? "CP949"
            : !strcmp(out->encoding, "cp1252") ? "CP1252"
                                               : out->encoding,
            out);
}
