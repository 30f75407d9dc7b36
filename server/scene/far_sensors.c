/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds sensors whose configured position is implausibly far from the surface of their asset. */
#include "scene/far_sensors.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"

double far_limit_m(const struct scene_asset *asset)
{
    const double *min = asset->bounds_min_m, *max = asset->bounds_max_m;
    double diagonal_m = sqrt(pow(max[0] - min[0], 2) + pow(max[1] - min[1], 2) + pow(max[2] - min[2], 2));
    return fmin(0.25, 0.05 * diagonal_m);
}

static int farthest_first(const void *pa, const void *pb)
{
    const struct far_sensor *a = pa, *b = pb;
    return (b->sensor->surface_distance_m > a->sensor->surface_distance_m) -
           (b->sensor->surface_distance_m < a->sensor->surface_distance_m);
}

struct far_sensor *far_sensors_find(const struct scene *scene, size_t *count)
{
    struct far_sensor *found = NULL;
    size_t capacity = 0;
    *count = 0;
    for (size_t a = 0; a < scene->asset_count; a++) {
        const struct scene_asset *asset = &scene->assets[a];
        for (size_t s = 0; s < asset->sensor_count; s++) {
            if (asset->sensors[s].surface_distance_m <= far_limit_m(asset) || scene->plant->tags[asset->sensors[s].tag].place.assumed)
                continue;
            mem_grow(&found, &capacity, *count + 1, sizeof(*found));
            found[(*count)++] = (struct far_sensor){ .asset = asset, .sensor = &asset->sensors[s], .limit_m = far_limit_m(asset) };
        }
    }
    if (found)
        qsort(found, *count, sizeof(*found), farthest_first);
    return found;
}
