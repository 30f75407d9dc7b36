/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One character after the other. */
#include "preprocess/import/encoding.h"

#include "base/mem.h"
#include "base/text.h"
#include "base/utf8.h"

char *encoding_to_utf8(const char *text, size_t length, bool latin1)
{
    struct text out = { 0 };
    bool valid = true;
    for (size_t i = 0; i < length && valid;) {
        size_t bytes = utf8_length(text + i, length - i);
        valid = bytes > 0;
        i += bytes;
    }
    for (size_t i = 0; i < length;) {
        unsigned char c = (unsigned char)text[i];
        size_t bytes = utf8_length(text + i, length - i);
        if (c < 32 || c == 127)
            text_add_bytes(&out, " ", 1);
        else if (valid || (!latin1 && bytes > 0))
            text_add_bytes(&out, text + i, bytes);
        else if (c < 128)
            text_add_bytes(&out, text + i, 1);
        else if (latin1 && c >= 160)
            text_add_bytes(&out, (const char[2]){ (char)(0xc0 | c >> 6), (char)(0x80 | (c & 63)) }, 2);
        else
            text_add_bytes(&out, "\xef\xbf\xbd", 3);
        i += valid || (!latin1 && bytes > 0) ? bytes : 1;
    }
    char *copy = mem_strdup(out.at ? out.at : "");
    text_finish(&out);
    return copy;
}
