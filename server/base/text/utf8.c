/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decodes UTF-8: the first byte determines the number of following bytes and the range of the second one. */
#include "base/text/utf8.h"

#include <string.h>

size_t utf8_length(const char *text, size_t left)
{
    const unsigned char *p = (const unsigned char *)text;
    unsigned char first = p[0], low = 0x80, high = 0xBF;
    size_t count;
    if (first < 0x80)
        return first != 0;
    if (first >= 0xC2 && first <= 0xDF)
        count = 2;
    else if (first >= 0xE0 && first <= 0xEF)
        count = 3;
    else if (first >= 0xF0 && first <= 0xF4)
        count = 4;
    else
        return 0;
    if (first == 0xE0)
        low = 0xA0;
    else if (first == 0xED)
        high = 0x9F;
    else if (first == 0xF0)
        low = 0x90;
    else if (first == 0xF4)
        high = 0x8F;
    if (count > left || p[1] < low || p[1] > high)
        return 0;
    for (size_t i = 2; i < count; i++)
        if (p[i] < 0x80 || p[i] > 0xBF)
            return 0;
    return count;
}

void utf8_drop_invalid(char *text)
{
    size_t kept = 0;
    for (size_t at = 0, count = strlen(text), step; at < count; at += step ? step : 1) {
        step = utf8_length(text + at, count - at);
        memmove(text + kept, text + at, step);
        kept += step;
    }
    text[kept] = 0;
}
