/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A font for text that DejaVu Sans has no letters for. Thread: any. */
#ifndef RENDER_OVERLAY_TEXT_FACE_H
#define RENDER_OVERLAY_TEXT_FACE_H
#include <cairo.h>
#include <stdbool.h>

/* Where the text has letters beyond Latin, Greek and Cyrillic, sets the installed font that has them best, as heavy as that which is set
   (by cairo_select_font_face()); else changes nothing. */
void text_face_choose(cairo_t *cairo, const char *text);

/* Returns whether there is a font that has all letters of the text. */
bool text_face_has(const char *text);

#endif
