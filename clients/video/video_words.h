/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Words of cards and strips, in English, Korean and German (clients/web/words/video.*.js). Thread: any. */
#ifndef VIDEO_WORDS_H
#define VIDEO_WORDS_H
#include <glib.h>

#include "render/view.h"
#include "words_video.h"

#define VIDEO_MEMBER(name, ...) VIDEO_##name,
enum video_word { VIDEO_WORDS(VIDEO_MEMBER) VIDEO_WORDS };
#undef VIDEO_MEMBER

/* Chooses the language of cards and strip: en, ko or de. Says so if no installed font has its letters. Before any other call. */
void video_choose_language(const char *language);
enum language video_language(void); /* English until one is chosen */

/* Returns a text with values put in, in this order; NULL where it has none, or one. g_free. */
char *video_say(enum language language, enum video_word word, const char *a, const char *b);

#endif
