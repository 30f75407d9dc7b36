/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What an overlay says, in English, Korean or German. */
#ifndef RENDER_OVERLAY_WORDS_H
#define RENDER_OVERLAY_WORDS_H
#include <stdbool.h>
#include <stddef.h>

#include "render/view.h"

enum overlay_word {
    WORD_NO_LIMITS,
    WORD_NO_DATA,
    WORD_UNCERTAIN,
    WORD_DRAWN_ERROR,
    WORD_DRAWN_ERROR_2,
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
    WORD_HELD_SINCE,
    WORD_UNKNOWN_THEN,
    WORD_FROM, /* {}: where overlay_say() puts something in */
    WORD_HOT_SPOT,
    WORD_HOT_SPOT_SIZE, /* metres, percent */
    WORD_SINCE,
    WORD_ALARMS,
    WORD_WORST,
    WORD_NO_VALUES,
    WORD_OLD_S,
    WORD_OLD_MIN,
    WORD_OLD_H,
    WORD_CONFIGURATION,
    WORD_CLOCK_UNSET,
    WORD_SIMULATED,
    WORD_NO_LIVE_DATA,
    WORD_HISTORY,
    WORD_NO_DATA_THEN,
    WORD_UNSEEN_ONE,
    WORD_UNSEEN,
    WORD_UNSEEN_SUCH_AS,
    WORD_LOOKS, /* and the others by enum look after it */
    WORD_LOOKS_LAST = WORD_LOOKS + LOOK_MATERIALS,
    WORD_INTERPOLATIONS, /* likewise */
    WORD_INTERPOLATIONS_LAST = WORD_INTERPOLATIONS + INTERPOLATIONS - 1,
    WORD_DISTANCES, /* likewise */
    WORD_DISTANCES_LAST = WORD_DISTANCES + DISTANCES - 1,
    WORD_POWER,
    WORD_STRENGTH,
    WORD_DECAY,
    WORD_RADIUS,
    WORD_RADIUS_AUTOMATIC,
    WORD_REACH,
    WORD_REACH_UNLIMITED,
    WORD_NOT_FILLED,
    WORD_FILLED,
    WORD_WEIGHTED,
    WORD_AS_CONFIGURED,
    OVERLAY_WORDS
};

/* Returns a word or a sentence. Static. Thread: any. */
const char *overlay_word(enum language language, enum overlay_word word);
/* Finds a language by its name: en, ko or de. Returns false if it is none of them. */
bool overlay_language_find(const char *name, enum language *out);
/* Writes a sentence into out, with values put in, in this order; b: NULL where it has one. Likewise. */
void overlay_say(enum language language, enum overlay_word word, const char *a, const char *b, char *out, size_t size);

#endif
