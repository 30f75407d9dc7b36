/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a video says of itself, in English, Korean and German. Thread: any. */
#ifndef VIDEO_WORDS_H
#define VIDEO_WORDS_H
#include <glib.h>

#include "render/view.h"

enum video_word {
    /* Headlines of cards */
    VIDEO_STARTING,
    VIDEO_NOT_LET_IN,
    VIDEO_NO_VIEW,
    VIDEO_NO_PICTURE,
    VIDEO_TOO_SLOW,
    VIDEO_SILENT,
    VIDEO_NO_CONNECTION,
    VIDEO_NO_VALUES,
    /* What else they say */
    VIDEO_SINCE,
    VIDEO_NOTHING_YET,
    VIDEO_TOKEN,
    VIDEO_TOKENS,
    VIDEO_ANSWERS,
    VIDEO_VIEWS,
    VIDEO_NONE,
    VIDEO_TOOK,
    VIDEO_EARLIER,
    VIDEO_NO_PNG,
    VIDEO_NO_ANSWER,
    VIDEO_NO_URL,
    VIDEO_NO_VALUE,
    VIDEO_SAID, /* what a server or a library says, as it is */
    /* The strip */
    VIDEO_AGE_S,
    VIDEO_AGE_MIN,
    VIDEO_WORDS
};

/* Chooses the language of cards and strip: en, ko or de. Says so if no installed font has its letters. Before any other call. */
void video_choose_language(const char *language);
enum language video_language(void); /* English until one is chosen */

/* Returns a text with values put in, in this order; NULL where it has none, or one. g_free. */
char *video_say(enum language language, enum video_word word, const char *a, const char *b);

#endif
