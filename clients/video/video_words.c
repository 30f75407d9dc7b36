/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "video_words.h"

#include <string.h>

#define VIDEO_ROW(name, key, ...) { __VA_ARGS__ },
static const char *const words[VIDEO_WORDS][LANGUAGES] = { VIDEO_WORDS(VIDEO_ROW) };

char *video_say(enum language language, enum video_word word, const char *a, const char *b)
{
    const char *values[] = { a, b };
    GString *out = g_string_new(NULL);
    const char *text = words[word][language];
    for (gsize i = 0; i < G_N_ELEMENTS(values); i++) {
        const char *blank = strstr(text, "{}");
        if (!blank || !values[i])
            break;
        g_string_append_len(out, text, blank - text);
        g_string_append(out, values[i]);
        text = blank + 2;
    }
    g_string_append(out, text);
    return g_string_free(out, FALSE);
}
