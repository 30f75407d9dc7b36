/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What legend and labels say, in English, Korean or German. */
#ifndef RENDER_OVERLAY_WORDS_H
#define RENDER_OVERLAY_WORDS_H
#include <stdbool.h>
#include <stddef.h>

enum overlay_word {
    WORD_NO_LIMITS,
    WORD_NO_DATA,
    WORD_UNCERTAIN,
    WORD_UNPROVEN,
    WORD_PLACE_ASSUMED,
    WORD_DIRECTION_UNKNOWN,
    WORD_PRIORITY_1, /* and the others after it */
    WORD_PRIORITY_2,
    WORD_PRIORITY_3,
    WORD_PRIORITY_4,
    WORD_BY_LIMITS,
    WORD_LOGARITHMIC,
    WORD_DEVIATION,
    WORD_MISREAD,
    WORD_GLOSSY, /* two lines */
    WORD_GLOSSY_2,
    WORD_BAD,
    WORD_UNKNOWN_THEN,
    WORD_FROM, /* {}: where overlay_say() puts something in */
    WORD_HOT_SPOT,
    WORD_HOT_SPOT_SIZE, /* metres, percent */
    WORD_SINCE,
    WORD_ALARMS,
    WORD_WORST,
    OVERLAY_WORDS
};

/* Chooses the language of all that this process draws: en (until then), ko or de. Returns false if it is none of them. Before anything is
   drawn. */
bool overlay_words_choose(const char *language);
/* Returns a word or a sentence. Static. Thread: any. */
const char *overlay_word(enum overlay_word word);
/* Writes a sentence into out, with values put in, in this order; b: NULL where it has one. Likewise. */
void overlay_say(enum overlay_word word, const char *a, const char *b, char *out, size_t size);

#endif
