/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Texts of the overlay in English, Korean or German. They are the same as the page's (clients/web/words/overlay.*.js). */
#ifndef RENDER_OVERLAY_WORDS_H
#define RENDER_OVERLAY_WORDS_H
#include <stdbool.h>
#include <stddef.h>

#include "render/view.h"
#include "words_overlay.h"

#define OVERLAY_MEMBER(name, ...) WORD_##name,
enum overlay_word {
    OVERLAY_WORDS(OVERLAY_MEMBER) OVERLAY_WORDS,
    /* text of the first enum look (way of colouring); the texts of the other looks follow in the order of the enum */
    WORD_LOOKS = WORD_LOOK_DEFAULT,
    WORD_INTERPOLATIONS = WORD_INTERPOLATION_SHEPARD,
    WORD_DISTANCES = WORD_DISTANCE_GEODESIC,
};
#undef OVERLAY_MEMBER

/* Returns a word or sentence of the overlay in the given language; static storage. Call from any thread. */
const char *overlay_word(enum language language, enum overlay_word word);
/* Finds a language by its code: en, ko or de. Returns false for any other. */
bool overlay_language_find(const char *name, enum language *out);
/* Writes a sentence into `out`, replacing each {} by a, then b. b: NULL if the sentence has one {}. Call from any thread. */
void overlay_say(enum language language, enum overlay_word word, const char *a, const char *b, char *out, size_t size);

#endif
