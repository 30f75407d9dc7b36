/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Counts triangles before it chooses levels. */
#include "render/detail.h"

#include "render/stage.h"

/* Of the silhouette, at most. */
static const double MOST_PX[] = { [TIER_MOVING] = 1.0, [TIER_STILL] = 0.7 };
/* Pictures are drawn truer as long as they have no more than these. Still ones, from which people read values: 2.5 million take 0.45 s of
   work on a processor, 0.3 s with levels. Moving ones: one asset, or a few; more would make a picture late. */
static const int TRIANGLES[] = { [TIER_MOVING] = 300000, [TIER_STILL] = 3000000 };

static bool has_room(const struct picture *picture, double error_px)
{
    int left = TRIANGLES[picture->view->tier];
    for (size_t i = 0; i < picture->visible_count && left >= 0; i++)
        left -= detail_level(picture, picture->visible[i], error_px)->triangles;
    return left >= 0;
}

double detail_error_px(const struct picture *picture)
{
    /* Few, and far apart: while a camera moves, levels seldom change because of others. */
    static const double parts[] = { 0, 0.125, 0.25, 0.5 };
    double most_px = MOST_PX[picture->view->tier];
    for (size_t i = 0; i < sizeof(parts) / sizeof(parts[0]); i++)
        if (has_room(picture, parts[i] * most_px))
            return parts[i] * most_px;
    return most_px;
}

const struct model_level *detail_level(const struct picture *picture, int asset, double error_px)
{
    if (error_px == 0)
        return &picture->stage->of_asset[asset]->levels[0];
    return stage_level(picture->stage, &picture->shot, asset, error_px);
}
