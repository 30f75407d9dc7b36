/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws white text into a frame with Pango, which finds a font for each script. Call from one thread only. */
#ifndef VIDEO_BRUSH_H
#define VIDEO_BRUSH_H
#include <cairo.h>
#include <stdbool.h>

struct brush_box {
    double x, y, width, height;
};

enum brush_align { BRUSH_LEFT, BRUSH_CENTRE, BRUSH_RIGHT };
/* Draws one line of text at the top of a box; a text that is wider than the box ends with an ellipsis. */
void brush_text(cairo_t *cairo, const struct brush_box *box, double size_px, bool bold, enum brush_align align, const char *text);
/* Returns the width in pixels of a text in one line. */
double brush_width(cairo_t *cairo, double size_px, bool bold, const char *text);

#endif
