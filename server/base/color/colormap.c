/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The built-in colour maps, and the out-of-range colours of other maps. */
#include "base/color/colormap.h"

#include <math.h>
#include <string.h>

#include "base/color/lab.h"
#include "colormaps.h" /* made by deploy/colormaps */

/* Chooses the out-of-range colour: the candidate that is farthest from all colours of the map. */
static void choose_outside(const struct colormap *map, const uint8_t candidates[4][3], uint8_t out[3])
{
    double farthest = -1;
    for (int k = 0; k < 4; k++) {
        double lab[3], nearest = INFINITY;
        lab_from_rgb(candidates[k], lab);
        for (int i = 0; i < 256; i += 3) {
            double at[3];
            lab_from_rgb(map->rgb[i], at);
            nearest = fmin(nearest, hypot(hypot(at[0] - lab[0], at[1] - lab[1]), at[2] - lab[2]));
        }
        if (nearest > farthest)
            memcpy(out, candidates[k], 3);
        farthest = fmax(farthest, nearest);
    }
}

void colormap_complete(struct colormap *map)
{
    static const uint8_t below[4][3] = { { 16, 26, 94 }, { 169, 205, 255 }, { 0, 0, 0 }, { 0, 128, 128 } };
    static const uint8_t above[4][3] = { { 125, 10, 30 }, { 255, 79, 216 }, { 255, 255, 255 }, { 90, 60, 0 } };
    choose_outside(map, below, map->below);
    choose_outside(map, above, map->above);
    colormap_rate_shading(map);
}
