/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses the error bound of a frame's levels of detail so that the frame stays within its triangle budget. */
#include "render/plan/lod_selection.h"

/* Upper limit of the error bound of levels of detail, in pixels, by tier (preview or refined). Silhouettes may be displaced by
   this much. */
static const double MAX_ERROR_PX[] = { [TIER_PREVIEW] = 1.0, [TIER_REFINED] = 0.7 };
/* Triangle budget by tier (preview or refined). A frame lowers its error bound below MAX_ERROR_PX as long as it has at most this many
   triangles. The budget of refined frames is generous, because people read values from them. A preview that draws more than a few assets in
   their finest level would take too long. */
static const int TRIANGLE_BUDGET[] = { [TIER_PREVIEW] = 300000, [TIER_REFINED] = 3000000 };

static bool has_room(const struct lod_params *params, double error_px)
{
    int left = TRIANGLE_BUDGET[params->tier];
    for (size_t i = 0; i < params->visible_count && left >= 0; i++)
        left -= lod_level(params->gpu_scene, params->constants, params->visible[i], error_px)->triangles;
    return left >= 0;
}

double lod_error_px(const struct lod_params *params)
{
    /* Fractions of MAX_ERROR_PX that are tried as error bounds of levels of detail, smallest first. They are few and widely
       spaced, so that an asset seldom changes its level of detail because of other assets while a camera moves. */
    static const double parts[] = { 0, 0.125, 0.25, 0.5 };
    double max_error_px = MAX_ERROR_PX[params->tier];
    for (size_t i = 0; i < sizeof(parts) / sizeof(parts[0]); i++)
        if (has_room(params, parts[i] * max_error_px))
            return parts[i] * max_error_px;
    return max_error_px;
}

const struct model_level *lod_level(const struct gpu_scene *gpu_scene, const struct view_constants *constants, int asset, double error_px)
{
    if (error_px == 0)
        return &gpu_scene->of_asset[asset]->levels[0];
    return gpu_scene_level(gpu_scene, constants, asset, error_px);
}
