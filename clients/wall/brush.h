/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text and colours of panes. Thread: one. */
#ifndef WALL_BRUSH_H
#define WALL_BRUSH_H
#include <cairo.h>
#include <stdbool.h>
#include <stdint.h>

#include "render/overlay/labels.h"

enum {
    INK = 0x1d252d,
    INK_2 = 0x4d5964,
    GROUND = 0xd3d7db,
    SURFACE = 0xf4f5f6,
    RAISED = 0xffffff,
    LINE = 0xb7bec5,
    ALERT = 0xc40d20,
    WHITE = 0xffffff
};

void brush_colour(cairo_t *cairo, uint32_t rgb);
void brush_fill(cairo_t *cairo, const struct box *box, uint32_t rgb);
enum brush_align { ALIGN_LEFT, ALIGN_CENTRE, ALIGN_RIGHT };
/* A text in a box, its first line at the top: cut to its width with an ellipsis, or, with `wraps`, in as many lines as there is room for.
   Returns
   the width and the height that it takes. */
struct box brush_text(cairo_t *cairo, const struct box *box, double size_px, bool bold, uint32_t rgb, enum brush_align align, bool wraps,
                      const char *text);
/* A text in one line, with smaller letters where there is no room for so large ones, down to two thirds. */
void brush_text_fitting(cairo_t *cairo, const struct box *box, double size_px, bool bold, uint32_t rgb, enum brush_align align,
                        const char *text);
/* Returns the width and height of a text in one line. */
struct box brush_measure(cairo_t *cairo, double size_px, bool bold, const char *text);
/* Returns what brush_text() takes in a box of that width and any height, where it wraps. */
struct box brush_measure_wrapped(cairo_t *cairo, double width_px, double size_px, bool bold, const char *text);
/* Draws the badge of a priority, so large, at its upper left corner; hollow: its cause has gone. */
void brush_badge(cairo_t *cairo, double x, double y, double size_px, int priority, bool hollow);
/* Returns the colour of a priority. */
uint32_t brush_priority(int priority);

#endif
