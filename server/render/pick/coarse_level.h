/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The level of detail in which isoline points and arrow positions are searched. Pure. */
#ifndef RENDER_PICK_COARSE_LEVEL_H
#define RENDER_PICK_COARSE_LEVEL_H
#include "scene/scene.h"

double coarse_size_m(const struct scene_asset *asset); /* returns the longest side of the asset's bounding box */
/* Returns the coarsest level with an error of at most a hundredth of coarse_size_m(); it belongs to the asset's file. Triangle numbers of
   arrow positions count through the primitives of this level. */
const struct asset_level *coarse_level(const struct scene_asset *asset);

#endif
