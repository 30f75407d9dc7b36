/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Colour maps: 256 sRGB colours each, from shaders/maps/NAME.csv (r,g,b per line, 0..255), embedded at build; and those that are added
   before other threads begin. Then immutable. Thread: any. */
#ifndef FIELD_COLORMAP_H
#define FIELD_COLORMAP_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "plant/plant.h"

#define COLORMAP_SHADING 7.0
struct colormap {
    const char *name; /* "relief" (the default) and "calm": low contrast, for shaded 3D; "viridis", "cividis", "diverging", "turbo" */
    uint8_t rgb[256][3];
    double shading; /* how far light may move L*, up and down: COLORMAP_SHADING at most, less where lightness tells much of the value */
    bool safe;      /* read right within 3 % of the range in 95 of 100 shaded pixels, also after JPEG and by deuteranopes */
    uint8_t below[3], above[3]; /* colours for < MIN and > MAX; not on the map */
};

/* Adds a map, or changes one that was added; it is judged, and gets colours for what is outside. Index, or -1: the name is that of a
   built-in one, or there are too many. */
int colormap_add(const char *name, const uint8_t rgb[256][3]);
void colormaps_of_plant(const struct plant *plant);
/* Works out shading and safe from the colours; some milliseconds. Those of the embedded maps stand in their files. */
void colormap_rate_shading(struct colormap *map);

size_t colormap_count(void);
const struct colormap *colormap_at(size_t index); /* 0 is the default */
/* Colours of places between limits, -3 to 3 (field/limits.h): not on the list, since it does not show values. */
const struct colormap *colormap_operator(void);
int colormap_find(const char *name); /* index or -1 */

#endif
