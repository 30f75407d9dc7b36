/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses a coarse level of detail of an asset, for isoline points and arrows. */
#include "render/pick/coarse_level.h"

#include <math.h>

static const double MAX_ERROR_PART = 0.01; /* largest geometric error of the coarse level, as a fraction of the asset's size */

double coarse_size_m(const struct scene_asset *asset)
{
    double size_m = 0;
    for (int c = 0; c < 3; c++)
        size_m = fmax(size_m, asset->bounds_max_m[c] - asset->bounds_min_m[c]);
    return size_m;
}

const struct asset_level *coarse_level(const struct scene_asset *asset)
{
    const struct asset_view *view = &asset->file->view;
    const double error_m = MAX_ERROR_PART * coarse_size_m(asset);
    uint32_t level = 0;
    while (level + 1 < view->header->level_count && (double)view->levels[level + 1].error_m <= error_m)
        level++;
    return &view->levels[level];
}
