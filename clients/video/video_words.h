/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Texts of the text card and the strip in English, Korean and German (clients/web/words/video.*.js). Call from any thread. */
#ifndef VIDEO_WORDS_H
#define VIDEO_WORDS_H
#include <glib.h>

#include "render/view.h"
#include "words_video.h"

#define VIDEO_MEMBER(name, ...) VIDEO_##name,
enum video_word { VIDEO_WORDS(VIDEO_MEMBER) VIDEO_WORDS };
#undef VIDEO_MEMBER

/* Returns the text of `word` (g_free). a and b replace its placeholders in this order; NULL for a placeholder that the text does not
   have. */
char *video_say(enum language language, enum video_word word, const char *a, const char *b);

#endif
