/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws one frame of the video: a picture of the plant, and below it a strip with title, clock and the age of the values.
   Without a recent picture, a text card with the reason takes its place. Call from one thread only. */
#ifndef VIDEO_CANVAS_H
#define VIDEO_CANVAS_H
#include <cairo.h>
#include <glib.h>
#include <stdbool.h>

#include "render/view.h"

struct shown {                /* content of a frame; owned by the source (source.h), valid until its next call */
    cairo_surface_t *picture; /* picture of the plant; NULL: a text card is drawn instead */
    /* texts of the text card, shown while there is no recent picture: headline in large letters, and below it the reason */
    const char *headline, *detail;
    gint64 since_us; /* UTC time in microseconds since which the card's reason has applied; 0: the card shows no time */
    const char *title;
    gint64 age_ms;   /* age of the oldest value in the picture, milliseconds; -1: it has no values */
    GTimeZone *zone; /* time zone of the plant */
    enum language words; /* language of card and strip */
};

struct canvas {
    int width_px, height_px;
    bool time_code;
};

/* Returns the height in pixels of the plant's picture in a video of height_px; the strip with title and clock below it takes
   the rest. */
int canvas_picture_px(int height_px);
/* Draws the frame for the instant utc_us into the pixels (BGRX). If canvas->time_code is set, the bottom row of the frame is a
   machine-readable time code of CANVAS_CODE_BITS blocks, white for 1. From left to right they are: 1, 0, the tenths of seconds since 1970
   as CANVAS_TIME_BITS bits with the highest first, 1 if the frame shows a text card, and the parity of all bits before. */
void canvas_draw(const struct canvas *canvas, guint8 *bgrx, int stride_bytes, const struct shown *look, gint64 utc_us);
enum { CANVAS_TIME_BITS = 36, CANVAS_CODE_BITS = CANVAS_TIME_BITS + 4 };

#endif
