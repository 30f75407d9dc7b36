/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Colour maps: 256 sRGB colours each, from shaders/maps/NAME.csv (r,g,b per line, 0..255), embedded at build. Immutable. Thread: any.
   The legend's rule, which shaders follow too, with t = (value - MIN)/(MAX - MIN), all in 32-bit floats:
     value < MIN: below;  value > MAX: above;  else the colour number min(255, floor(256 t)), never a mixture of two.
     In steps of `interval`: bands start at MIN + k interval, k = min(floor((value - MIN)/interval), bands - 1), with
     bands = max(1, ceil((MAX - MIN)/interval - 0.001)). A whole band has the colour of its centre; MAX may cut the last one short. */
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
int colormap_find(const char *name);              /* index or -1 */
/* The colour of a value, by the legend's rule. value must be finite, min < max. */
void colormap_look_up(const struct colormap *map, double value, double min, double max, double interval, uint8_t rgb[3]);

#endif
