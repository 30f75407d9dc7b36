/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Level-of-detail selection: how far off the levels of a frame may be. The finest level shows the field to a step of colour; a coarser one
   shows it as true as its surface lies, so that at some pixels it is some steps off. So frames with room for more triangles are drawn truer
   than what is seen of shapes would need. Thread: any. */
#ifndef RENDER_PLAN_LOD_SELECTION_H
#define RENDER_PLAN_LOD_SELECTION_H
#include "render/gl/gpu_scene.h"

struct lod_params {
    const struct gpu_scene *gpu_scene;
    const struct view_constants *constants;
    enum tier tier;
    const int *visible; /* assets */
    size_t visible_count;
};
/* Returns the largest error of a frame's levels, in pixels; 0: the finest level of everything. It depends on the camera and on what is in
   sight only, so that equal views are equal frames, and is the same for all tiles of a frame. */
double lod_error_px(const struct lod_params *params);
/* Returns the coarsest level of an asset that errs by no more than that; 0: the finest. */
const struct model_level *lod_level(const struct gpu_scene *gpu_scene, const struct view_constants *constants, int asset, double error_px);

#endif
