/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The level that is searched for places of lines and arrows. Pure. */
#ifndef RENDER_PICK_COARSE_LEVEL_H
#define RENDER_PICK_COARSE_LEVEL_H
#include "scene/scene.h"

double coarse_size_m(const struct scene_asset *asset); /* returns the longest side of its box */
/* Returns the coarsest level of the asset whose error is at most a hundredth of that; it belongs to the asset's file.
   Triangles of arrows are numbered through its primitives. */
const struct asset_level *coarse_level(const struct scene_asset *asset);

#endif
