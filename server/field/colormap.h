/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Colour maps: 256 sRGB colours each, from shaders/maps/NAME.csv (r,g,b per line, 0..255), embedded at build. Immutable. Thread: any. */
#ifndef FIELD_COLORMAP_H
#define FIELD_COLORMAP_H
#include <stddef.h>
#include <stdint.h>

struct colormap {
    const char *name; /* "relief" (the default, low contrast, for shaded 3D), "viridis", "cividis", "diverging", "turbo" */
    uint8_t rgb[256][3];
    uint8_t below[3], above[3]; /* colours for < MIN and > MAX; not on the map */
};

size_t colormap_count(void);
const struct colormap *colormap_at(size_t index); /* 0 is the default */
/* Colours of places between limits, -3 to 3 (field/limits.h): not on the list, since it does not show values. */
const struct colormap *colormap_operator(void);
int colormap_find(const char *name);              /* index or -1 */

#endif
