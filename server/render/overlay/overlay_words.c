/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/overlay/overlay_words.h"

#include <stdio.h>
#include <string.h>

static const char *const names[LANGUAGES] = { "en", "ko", "de" };

_Static_assert(LANGUAGE_EN == 0 && LANGUAGE_KO == 1 && LANGUAGE_DE == 2, "enum language must have the order of languages in the Makefile");
#define OVERLAY_ROW(name, key, ...) { __VA_ARGS__ },
static const char *const words[OVERLAY_WORDS][LANGUAGES] = { OVERLAY_WORDS(OVERLAY_ROW) };
_Static_assert(WORD_LOOKS + LOOK_MATERIALS == WORD_LOOK_MATERIALS, "words of looks must be in the order of enum look");
_Static_assert(WORD_INTERPOLATIONS + INTERPOLATION_GP == WORD_INTERPOLATION_GP,
               "words of interpolations must be in the order of enum interpolation");
_Static_assert(WORD_DISTANCES + DISTANCE_HEAT == WORD_DISTANCE_HEAT, "words of distances must be in the order of enum distance_mode");

bool overlay_language_find(const char *name, enum language *out)
{
    for (int i = 0; i < LANGUAGES; i++)
        if (!strcmp(name, names[i])) {
            *out = (enum language)i;
            return true;
        }
    return false;
}

const char *overlay_word(enum language language, enum overlay_word word)
{
    return words[word][language];
}

void overlay_say(enum language language, enum overlay_word word, const char *a, const char *b, char *out, size_t size)
{
    const char *text = words[word][language], *one = strstr(text, "{}"), *two = one ? strstr(one + 2, "{}") : NULL;
    snprintf(out, size, "%.*s%s%.*s%s%s", (int)(one ? one - text : (long)strlen(text)), text, one ? a : "",
             (int)(two ? two - one - 2 : 0), one ? one + 2 : "", two && b ? b : "", two ? two + 2 : one ? one + 2 : "");
}
