/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws one frame of the video: a picture of the plant or a card, and below it a strip with title, clock and the age of the values.
   Thread: one. */
#ifndef VIDEO_CANVAS_H
#define VIDEO_CANVAS_H
#include <cairo.h>
#include <glib.h>
#include <stdbool.h>

struct shown {                /* what is to be seen now; all belongs to who says it, until he says the next */
    cairo_surface_t *picture; /* NULL: the card */
    const char *headline, *detail;
    gint64 since_us; /* UTC, since when there is a card; 0: it does not matter */
    const char *title;
    gint64 age_ms;   /* of the oldest value; -1: none takes part */
    GTimeZone *zone; /* of the plant */
};

struct canvas {
    int width_px, height_px;
    bool time_code;
};

/* Returns the height of the picture that a video of this size shows; the strip has the rest. */
int canvas_picture_px(int height_px);
/* Draws over the pixels (BGRX) the frame of the instant utc_us. Below all, if it has a time code, is a row of CANVAS_CODE_BITS blocks,
   white for 1, from left to right: 1, 0, the bits of the tenths of seconds since 1970 from the highest of CANVAS_TIME_BITS on, 1 if this
   is a card, and the parity of all before it. */
void canvas_draw(const struct canvas *canvas, guint8 *bgrx, int stride_bytes, const struct shown *look, gint64 utc_us);
enum { CANVAS_TIME_BITS = 36, CANVAS_CODE_BITS = CANVAS_TIME_BITS + 4 };

#endif
