/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds a font for text with letters that DejaVu Sans lacks. Thread: any. */
#ifndef RENDER_OVERLAY_TEXT_FACE_H
#define RENDER_OVERLAY_TEXT_FACE_H
#include <cairo.h>
#include <stdbool.h>

/* If the text has letters beyond Latin, Greek and Cyrillic, sets the installed font that has most of these letters, in the weight set
   before by cairo_select_font_face(). Otherwise keeps the font. The drawing context caches the fonts found last. */
void text_face_choose(cairo_t *cairo, const char *text);

/* Returns whether an installed font has all letters of the text. */
bool text_face_has(const char *text);

#endif
