/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads values from the pixels of a picture that has a legend strip (protocol/strip_format.h), even after scaling or compression, or
   from a screenshot that contains the picture. Uses only the strip and the pixels. No input or output. */
#ifndef PROVENANCE_STRIP_READER_H
#define PROVENANCE_STRIP_READER_H
#include <stdbool.h>
#include <stdint.h>

#include "protocol/strip_format.h"

struct strip_picture {
    const uint8_t *bgrx; /* pixels of 4 bytes (blue, green, red, unused), rows from the top */
    int width_px, height_px, stride_bytes;
};

struct strip_found {
    struct strip strip;
    double left_px, top_px, cell_px, row_px; /* position of the strip in the picture, and width and height of its cells */
    int mended;                              /* number of bytes of the strip's machine-readable code that error correction repaired */
    /* CIELAB values of the legend's colours as they appear in this picture: below range, MIN to MAX, above range */
    double ramp[STRIP_SHADES][STRIP_INNER][3];
    double noise; /* CIELAB deviation, caused by compression, among pixels that should have the same colour */
};

enum strip_state { STRIP_VALUE, STRIP_BELOW, STRIP_ABOVE, STRIP_NO_COLOR };
struct strip_value {
    /* STRIP_NO_COLOR: the colour is not in the legend, as for the background, a label, or no data */
    enum strip_state state;
    /* Only for STRIP_VALUE. value: the pixel's value; low, high: range of values whose colours cannot be distinguished from the
       pixel's colour. */
    double value, low, high;
    double off; /* CIELAB distance of the pixel's colour from the nearest colour of the legend */
};

/* Finds the legend strip in a picture. Returns false, with the reason in *why (static text), if the picture has no readable strip. */
bool strip_find(const struct strip_picture *picture, struct strip_found *found, const char **why);
/* Reads the value that a pixel's colour represents. Returns false if the pixel is outside the picture, or on the legend strip. */
bool strip_read(const struct strip_picture *picture, const struct strip_found *found, int x_px, int y_px, struct strip_value *out);

#endif
