/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Colour maps of 256 sRGB colours each. deploy/colormaps generates the table of built-in maps from shaders/maps/NAME.csv. A
   plant's own maps are in plant/colormaps.h. Pure. Call from any thread. */
#ifndef BASE_COLOR_COLORMAP_H
#define BASE_COLOR_COLORMAP_H
#include <stdbool.h>
#include <stdint.h>

#define COLORMAP_SHADING 7.0
struct colormap {
    /* name: "relief" (the default) and "calm" (both low contrast, for shaded 3D), "viridis", "cividis", "diverging", "turbo" */
    char name[128];
    uint8_t rgb[256][3]; /* colours of values from MIN (index 0) to MAX (index 255) */
    /* largest change of the CIELAB lightness L*, up or down, with which shading may draw a surface: COLORMAP_SHADING, or less
       for maps whose colours differ mainly in lightness */
    double shading;
    /* true: from 95 of 100 pixels of a shaded surface, the value can be read off the legend to within 3 % of the range, even
       after JPEG compression and by deuteranopes */
    bool safe;
    uint8_t below[3], above[3]; /* colours for values below MIN and above MAX, clearly different from all colours of the map */
};

enum { COLORMAPS_BUILT_IN = 6 };
extern const struct colormap colormaps_built_in[COLORMAPS_BUILT_IN]; /* the built-in maps; the first one is the default */
/* The colour map of the operator's view, which shows how near a reading is to its tag's alarm limits. The position of a reading
   runs from -3 (far below the low limits) to 3 (far above the high ones); field/limits.h computes it. */
extern const struct colormap colormap_operator;

/* Computes `shading` and `safe` from the map's colours, and chooses the out-of-range colours. Takes a few milliseconds. */
void colormap_complete(struct colormap *map);
/* Computes only `shading` and `safe`, which is a part of colormap_complete(). */
void colormap_rate_shading(struct colormap *map);

#endif
