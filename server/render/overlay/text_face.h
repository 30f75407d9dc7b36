/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds a font for text with letters that DejaVu Sans lacks. Call from any thread. */
#ifndef RENDER_OVERLAY_TEXT_FACE_H
#define RENDER_OVERLAY_TEXT_FACE_H
#include <cairo.h>
#include <stdbool.h>

/* Sets the installed font that has most of the text's letters if some are beyond Latin, Greek and Cyrillic; otherwise keeps the font.
   Keeps the weight that cairo_select_font_face() has set. The drawing context caches the fonts found last. */
void text_face_choose(cairo_t *cairo, const char *text);

/* Returns whether an installed font has all letters of the text. */
bool text_face_has(const char *text);

#endif
