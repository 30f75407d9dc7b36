/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses levels of detail: the error bound of a frame, and each asset's level under that bound. The finest level shows the
   field accurately to one colour step. A coarser level's values are off by as much as its surface is displaced, which is
   several colour steps at some pixels. So a frame with few triangles uses finer levels than its silhouettes need. Call from any
   thread. */
#ifndef RENDER_PLAN_LOD_SELECTION_H
#define RENDER_PLAN_LOD_SELECTION_H
#include "render/gl/gpu_scene.h"

struct lod_params {
    const struct gpu_scene *gpu_scene;
    const struct view_constants *constants;
    enum tier tier;
    const int *visible; /* indices of the visible assets */
    size_t visible_count;
};
/* Returns the error bound of the frame's levels of detail, in pixels; 0: finest levels only. The result is the same for all
   tiles of a frame. It depends only on camera and visible assets, so that equal views give equal frames. */
double lod_error_px(const struct lod_params *params);
/* Returns the asset's coarsest level with an error of at most error_px; the finest level if error_px is 0. */
const struct model_level *lod_level(const struct gpu_scene *gpu_scene, const struct view_constants *constants, int asset, double error_px);

#endif
