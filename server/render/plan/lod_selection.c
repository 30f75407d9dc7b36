/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Counts triangles before it chooses levels. */
#include "render/plan/lod_selection.h"

/* Of the silhouette, at most. */
static const double MOST_PX[] = { [TIER_PREVIEW] = 1.0, [TIER_REFINED] = 0.7 };
/* Frames are drawn truer as long as they have no more than these. Refined ones, from which people read values: 2.5 million take 0.45 s of
   work on a processor, 0.3 s with levels. Previews: one asset, or a few; more would make a frame late. */
static const int TRIANGLES[] = { [TIER_PREVIEW] = 300000, [TIER_REFINED] = 3000000 };

static bool has_room(const struct lod_params *params, double error_px)
{
    int left = TRIANGLES[params->tier];
    for (size_t i = 0; i < params->visible_count && left >= 0; i++)
        left -= lod_level(params->gpu_scene, params->constants, params->visible[i], error_px)->triangles;
    return left >= 0;
}

double lod_error_px(const struct lod_params *params)
{
    /* Few, and far apart: while a camera moves, levels seldom change because of others. */
    static const double parts[] = { 0, 0.125, 0.25, 0.5 };
    double most_px = MOST_PX[params->tier];
    for (size_t i = 0; i < sizeof(parts) / sizeof(parts[0]); i++)
        if (has_room(params, parts[i] * most_px))
            return parts[i] * most_px;
    return most_px;
}

const struct model_level *lod_level(const struct gpu_scene *gpu_scene, const struct view_constants *constants, int asset, double error_px)
{
    if (error_px == 0)
        return &gpu_scene->of_asset[asset]->levels[0];
    return gpu_scene_level(gpu_scene, constants, asset, error_px);
}
