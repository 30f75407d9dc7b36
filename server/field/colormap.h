/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Colour maps: 256 sRGB colours each. Built-in maps come from shaders/maps/NAME.csv (r,g,b per line, 0..255), embedded at build; a plant's
   own maps are added before other threads start. Immutable afterwards. Thread: any. */
#ifndef FIELD_COLORMAP_H
#define FIELD_COLORMAP_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "plant/plant.h"

#define COLORMAP_SHADING 7.0
struct colormap {
    /* name of the map: "relief" (the default) and "calm": low contrast, for shaded 3D; "viridis", "cividis", "diverging", "turbo" */
    const char *name;
    uint8_t rgb[256][3];
    /* largest change of lightness L* that shading may cause, up or down: at most COLORMAP_SHADING, less for maps in which lightness shows
       much of the value */
    double shading;
    /* true if 95 of 100 shaded pixels are read correctly to within 3 % of the range, also after JPEG compression and by deuteranopes */
    bool safe;
    uint8_t below[3], above[3]; /* colours for values below MIN and above MAX; they differ clearly from all colours of the map */
};

/* Adds a map, or replaces an added map of the same name. Computes its `shading` and `safe` and chooses its out-of-range colours. Returns
   the map's index; -1 if the name belongs to a built-in map or there is no room. Thread: before others start. */
int colormap_add(const char *name, const uint8_t rgb[256][3]);
/* Adds the colour maps that the plant file defines. Thread: before others start. */
void colormaps_of_plant(const struct plant *plant);
/* Computes `shading` and `safe` from the map's colours; takes a few milliseconds. The files of built-in maps already contain both. */
void colormap_rate_shading(struct colormap *map);

/* Returns the number of maps. */
size_t colormap_count(void);
/* Returns the map with this index; 0 is the default. */
const struct colormap *colormap_at(size_t index);
/* Returns the map of the operator's view, which shows where a reading is between its alarm limits: -3 to 3 (field/limits.h). It has no
   index and no entry in the list of maps. */
const struct colormap *colormap_operator(void);
/* Returns the index of the map with this name, or -1. */
int colormap_find(const char *name);

#endif
