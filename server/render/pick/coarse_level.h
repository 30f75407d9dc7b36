/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses the level of detail used to find isoline points and arrow positions. Pure. */
#ifndef RENDER_PICK_COARSE_LEVEL_H
#define RENDER_PICK_COARSE_LEVEL_H
#include "scene/scene.h"

double coarse_size_m(const struct scene_asset *asset); /* returns the longest side of the asset's bounding box */
/* Returns the coarsest level with an error of at most a hundredth of coarse_size_m(); the result points into the asset's file. The triangle
   indices of arrow positions count all triangles of this level, primitive after primitive. */
const struct asset_level *coarse_level(const struct scene_asset *asset);

#endif
