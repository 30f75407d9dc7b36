/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the farthest vertex in each of many directions, distributed evenly over the sphere. */
#include "scene/extremes.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "plant/models/transform.h"
#include "scene/main_part.h"

enum { DIRECTIONS = 96 };
/* Limits below for recognising an asset as the plant's ground: it has no sensor, is low for its size (even with lamps and
   kerbs), and covers most of the plant's area. */
/* GROUND_HEIGHT: largest height of ground, as a fraction of its larger side; GROUND_PART: smallest area of ground, as a
   fraction of the plant's area */
static const double GROUND_HEIGHT = 0.25, GROUND_PART = 0.8;
/* minimum length in metres of the larger side of a ground plate; a smaller plate counts as equipment */
static const double GROUND_LEAST_M = 5;
/* largest error of the level of detail whose vertices are searched, relative to the asset's size; vertices of a coarser level
   would make a view crop the asset */
static const double LEVEL_ERROR = 0.005;

static double area_of(const double min_m[3], const double max_m[3], int up)
{
    return (max_m[0] - min_m[0]) * (max_m[up == 1 ? 2 : 1] - min_m[up == 1 ? 2 : 1]);
}

static bool is_ground(const struct scene *scene, const struct scene_asset *asset)
{
    int up = scene->plant->up == AXIS_Y ? 1 : 2, other = up == 1 ? 2 : 1;
    const double *min_m = asset->bounds_min_m, *max_m = asset->bounds_max_m;
    double side_m = fmax(max_m[0] - min_m[0], max_m[other] - min_m[other]);
    return asset->sensor_count == 0 && side_m >= GROUND_LEAST_M && max_m[up] - min_m[up] <= GROUND_HEIGHT * side_m &&
           area_of(min_m, max_m, up) >= GROUND_PART * area_of(scene->bounds_min_m, scene->bounds_max_m, up);
}

static uint32_t level_vertices(const struct scene_asset *asset)
{
    const struct asset_view *view = &asset->file->view;
    double size_m = 0;
    uint32_t level = view->header->level_count - 1;
    for (int i = 0; i < 3; i++)
        size_m = fmax(size_m, (double)(view->header->bounds_max_m[i] - view->header->bounds_min_m[i]));
    while (level > 0 && (double)view->levels[level].error_m > LEVEL_ERROR * size_m)
        level--;
    return view->levels[level].vertex_count;
}

static void add_asset(const struct scene *scene, const struct scene_asset *asset, const double (*directions)[3], double *most,
                      double (*points)[3])
{
    const struct asset_view *view = &asset->file->view;
    const double *m = asset->placement;
    uint32_t count = level_vertices(asset);
    char *held = NULL; /* by vertex: 1 if the vertex lies within the main part of the plant; NULL: all vertices do */
    if (asset->stray) {
        held = mem_array(count, 1);
        for (uint32_t v = 0; v < count; v++) {
            double place[3] = { (double)view->positions_m[v][0], (double)view->positions_m[v][1], (double)view->positions_m[v][2] };
            transform_point(m, place, place);
            held[v] = main_part_holds(scene, place);
        }
    }
    for (int d = 0; d < DIRECTIONS; d++) {
        float local[3];
        uint32_t best = 0;
        float farthest = -INFINITY;
        for (int i = 0; i < 3; i++)
            local[i] = (float)(directions[d][0] * m[4 * i] + directions[d][1] * m[4 * i + 1] + directions[d][2] * m[4 * i + 2]);
        for (uint32_t v = 0; v < count; v++) {
            const float *p = view->positions_m[v];
            float far = p[0] * local[0] + p[1] * local[1] + p[2] * local[2];
            if (far > farthest && (!held || held[v])) {
                farthest = far;
                best = v;
            }
        }
        double place[3] = { view->positions_m[best][0], view->positions_m[best][1], view->positions_m[best][2] };
        transform_point(asset->placement, place, place);
        double far = place[0] * directions[d][0] + place[1] * directions[d][1] + place[2] * directions[d][2];
        if (farthest > -INFINITY && far > most[d]) {
            most[d] = far;
            memcpy(points[d], place, sizeof(place));
        }
    }
    mem_free(held);
}

void extremes_find(struct scene *scene)
{
    double directions[DIRECTIONS][3], points[DIRECTIONS][3], most[DIRECTIONS];
    for (int d = 0; d < DIRECTIONS; d++) { /* makes the directions: points on a spiral around the sphere, turned by the golden angle */
        double z = 1 - (2 * d + 1.0) / DIRECTIONS, turn = d * M_PI * (3 - sqrt(5)), flat = sqrt(1 - z * z);
        memcpy(directions[d], (double[]){ flat * cos(turn), flat * sin(turn), z }, sizeof(directions[d]));
        most[d] = -INFINITY;
    }
    /* searches in three rounds until a vertex is found: all assets but the ground and those hidden at start; then the ground
       too; then the hidden ones too */
    for (int round = 0; round < 3 && !isfinite(most[0]); round++)
        for (size_t i = 0; i < scene->asset_count; i++)
            if (!scene->assets[i].missing && (round > 0 || !is_ground(scene, &scene->assets[i])) &&
                (round > 1 || scene->plant->assets[i].start != PLANT_START_HIDDEN))
                add_asset(scene, &scene->assets[i], (const double(*)[3])directions, most, points);
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
