/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The colour maps available to a plant's pictures: the built-in ones, then those of its plant file. Call from any thread. */
#ifndef PLANT_COLORMAPS_H
#define PLANT_COLORMAPS_H
#include "plant/plant.h"

/* In these functions, plant NULL means that only the built-in colour maps exist. Index 0 is the default map. */
size_t colormap_count(const struct plant *plant);
const struct colormap *colormap_at(const struct plant *plant, size_t index);
/* Returns the index of the colour map with this name, or -1. */
int colormap_find(const struct plant *plant, const char *name);

/* Adds a colour map; no map may have that name yet. Returns false if the plant has PLANT_COLORMAPS maps already. Call before
   other threads start. */
bool colormap_add(struct plant *plant, const char *name, const uint8_t rgb[256][3]);

#endif
