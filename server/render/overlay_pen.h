/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the parts of the overlay draw with. Sizes grow with the picture: `unit` is one pixel at 1280x720. */
#ifndef RENDER_OVERLAY_PEN_H
#define RENDER_OVERLAY_PEN_H
#include <stdbool.h>

#include <cairo.h>

#include "render/frame.h"

struct box {
    double x, y, width, height;
};

enum { PEN_MAX_TAKEN = 512 };
struct pen {
    cairo_t *cairo;
    const struct frame *frame;
    const struct scene *scene;
    const struct snapshot *snapshot;
    double unit, text_px;
    struct box taken[PEN_MAX_TAKEN]; /* where nothing more may be put */
    int taken_count;
};

bool pen_is_free(const struct pen *pen, const struct box *box); /* inside the picture, and over nothing that is taken */
void pen_take(struct pen *pen, const struct box *box);
void pen_card(struct pen *pen, const struct box *box); /* a light plate with a thin rim, for text to stand on */
void pen_rgb(struct pen *pen, const uint8_t rgb[3]);
void pen_ink(struct pen *pen, double alpha);            /* the colour of text */
void pen_font(struct pen *pen, double size, bool bold); /* size: of text_px */
double pen_text_width(struct pen *pen, const char *text);
void pen_text(struct pen *pen, double x, double y, const char *text); /* from x, on a line through y; left where it starts */

/* How many decimals tell values apart that differ by a 500th of the range. */
int pen_decimals(double range);

void overlay_legend(struct pen *pen);
void overlay_markers(struct pen *pen);

#endif
