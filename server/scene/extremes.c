/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The vertex that lies farthest in each of many directions, spread evenly over the sphere. Coarse levels do: they err by centimetres. */
#include "scene/extremes.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "plant/transform.h"

enum { DIRECTIONS = 96 };
/* Ground has no sensor, is low for its size, lamps and kerbs on it included, and lies under most of the plant. */
static const double GROUND_HEIGHT = 0.25, GROUND_PART = 0.8; /* of its larger side; of the plant's area */

static double area_of(const double min_m[3], const double max_m[3], int up)
{
    return (max_m[0] - min_m[0]) * (max_m[up == 1 ? 2 : 1] - min_m[up == 1 ? 2 : 1]);
}

static bool is_ground(const struct scene *scene, const struct scene_asset *asset)
{
    int up = scene->plant->up == AXIS_Y ? 1 : 2, other = up == 1 ? 2 : 1;
    const double *min_m = asset->bounds_min_m, *max_m = asset->bounds_max_m;
    double side_m = fmax(max_m[0] - min_m[0], max_m[other] - min_m[other]);
    return asset->sensor_count == 0 && max_m[up] - min_m[up] <= GROUND_HEIGHT * side_m &&
           area_of(min_m, max_m, up) >= GROUND_PART * area_of(scene->bounds_min_m, scene->bounds_max_m, up);
}

static void add_asset(const struct scene_asset *asset, const double (*directions)[3], double *most, double (*points)[3])
{
    const struct asset_view *view = &asset->file->view;
    const double *m = asset->placement;
    uint32_t count = view->levels[view->header->level_count - 1].vertex_count;
    for (int d = 0; d < DIRECTIONS; d++) {
        float local[3];
        uint32_t best = 0;
        float farthest = -INFINITY;
        for (int i = 0; i < 3; i++)
            local[i] = (float)(directions[d][0] * m[4 * i] + directions[d][1] * m[4 * i + 1] + directions[d][2] * m[4 * i + 2]);
        for (uint32_t v = 0; v < count; v++) {
            const float *p = view->positions_m[v];
            float far = p[0] * local[0] + p[1] * local[1] + p[2] * local[2];
            if (far > farthest) {
                farthest = far;
                best = v;
            }
        }
        double place[3] = { view->positions_m[best][0], view->positions_m[best][1], view->positions_m[best][2] };
        transform_point(asset->placement, place, place);
        double far = place[0] * directions[d][0] + place[1] * directions[d][1] + place[2] * directions[d][2];
        if (count && far > most[d]) {
            most[d] = far;
            memcpy(points[d], place, sizeof(place));
        }
    }
}

void extremes_find(struct scene *scene)
{
    double directions[DIRECTIONS][3], points[DIRECTIONS][3], most[DIRECTIONS];
    for (int d = 0; d < DIRECTIONS; d++) { /* a spiral around the sphere, by the golden angle */
        double z = 1 - (2 * d + 1.0) / DIRECTIONS, turn = d * M_PI * (3 - sqrt(5)), flat = sqrt(1 - z * z);
        memcpy(directions[d], (double[]){ flat * cos(turn), flat * sin(turn), z }, sizeof(directions[d]));
        most[d] = -INFINITY;
    }
    for (int round = 0; round < 3 && !isfinite(most[0]); round++) /* without the ground, with it, with what starts hidden */
        for (size_t i = 0; i < scene->asset_count; i++)
            if (!scene->assets[i].missing && (round > 0 || !is_ground(scene, &scene->assets[i])) &&
                (round > 1 || scene->plant->assets[i].start != PLANT_START_HIDDEN))
                add_asset(&scene->assets[i], (const double(*)[3])directions, most, points);
    scene->extremes_m = mem_array(DIRECTIONS, sizeof(*scene->extremes_m));
    scene->extreme_count = 0;
    for (int d = 0; d < DIRECTIONS; d++) {
        bool is_new = isfinite(most[d]);
        for (size_t i = 0; i < scene->extreme_count && is_new; i++)
            is_new = memcmp(scene->extremes_m[i], points[d], sizeof(points[d])) != 0;
        if (is_new)
            memcpy(scene->extremes_m[scene->extreme_count++], points[d], sizeof(points[d]));
    }
}
