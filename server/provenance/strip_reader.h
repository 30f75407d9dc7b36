/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Values read from the pixels of a picture that has a legend strip (protocol/strip_format.h), whatever became of it since: scaled,
   compressed, part of a screenshot. Only the strip and the pixels are looked at. Pure. */
#ifndef PROVENANCE_STRIP_READER_H
#define PROVENANCE_STRIP_READER_H
#include <stdbool.h>
#include <stdint.h>

#include "protocol/strip_format.h"

struct strip_picture {
    const uint8_t *bgrx; /* rows from the top */
    int width_px, height_px, stride_bytes;
};

struct strip_found {
    struct strip strip;
    double left_px, top_px, cell_px, row_px; /* of the strip; width and height of its cells */
    int mended;                              /* bytes of its code that were wrong */
    double ramp[STRIP_SHADES][STRIP_INNER][3]; /* CIELAB of its colours as they are in this picture, MIN to MAX between those beyond */
    double noise;                            /* how far pixels of one colour lie from it, in CIELAB: what compression does */
};

enum strip_state { STRIP_VALUE, STRIP_BELOW, STRIP_ABOVE, STRIP_NO_COLOR };
struct strip_value {
    enum strip_state state;     /* NO_COLOR: nothing that the legend has: background, a label, no data */
    double value, low, high;    /* VALUE: what the pixel shows, and within which bounds its colour cannot be told apart */
    double off;                 /* how far its colour is from the legend's nearest, in CIELAB */
};

/* Finds the strip. Returns false, with the reason in *why (static text), if there is none that can be read. */
bool strip_find(const struct strip_picture *picture, struct strip_found *found, const char **why);
/* Reads the pixel. Returns false if it lies outside the picture, or on the strip. */
bool strip_read(const struct strip_picture *picture, const struct strip_found *found, int x_px, int y_px, struct strip_value *out);

#endif
