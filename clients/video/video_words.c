/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "video_words.h"

#include <stdio.h>
#include <string.h>

#include "render/overlay/overlay_words.h"
#include "render/overlay/text_face.h"

#define VIDEO_ROW(name, key, ...) { __VA_ARGS__ },
static const char *const words[VIDEO_WORDS][LANGUAGES] = { VIDEO_WORDS(VIDEO_ROW) };

static enum language chosen;

void video_choose_language(const char *language)
{
    overlay_language_find(language, &chosen);
    if (!text_face_has(overlay_word(chosen, WORD_NO_DATA)))
        fprintf(stderr, "no installed font has the letters of --language %s: boxes are shown instead; install fonts-nanum\n", language);
}

enum language video_language(void)
{
    return chosen;
}

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
