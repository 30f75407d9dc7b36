/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the main part of a scene, and counts each asset's triangles outside it. */
#include "scene/main_part.h"

#include <math.h>
#include <string.h>

#include "base/math/gap_split.h"
#include "base/math/vec.h"
#include "base/mem.h"
#include "plant/models/transform.h"

enum { LOGGED_ASSETS = 5 };

struct scene_tris {
    struct gap_tri *tris;
    size_t count;
};

static void add_asset(struct scene_tris *parts, const struct scene *scene, int asset, size_t *capacity)
{
    const struct scene_asset *of = &scene->assets[asset];
    const struct asset_view *view = &of->file->view;
    const struct asset_level *level = &view->levels[view->header->level_count - 1];
    for (uint32_t p = level->first_primitive; p < level->first_primitive + level->primitive_count; p++)
        for (uint32_t i = 0; i < view->primitives[p].index_count; i += 3) {
            struct gap_tri tri = { .owner = (uint32_t)asset };
            double normal[3];
            for (int k = 0; k < 3; k++) {
                const float *at = view->positions_m[view->indices[view->primitives[p].first_index + i + (uint32_t)k]];
                transform_point(of->placement, (double[3]){ (double)at[0], (double)at[1], (double)at[2] }, tri.at[k]);
            }
            vec_normal(tri.at[0], tri.at[1], tri.at[2], normal);
            tri.area_m2 = 0.5 * vec_length(normal);
            mem_grow(&parts->tris, capacity, parts->count + 1, sizeof(*parts->tris));
            parts->tris[parts->count++] = tri;
        }
}

bool main_part_holds(const struct scene *scene, const double place_m[3])
{
    for (int c = 0; c < 3; c++) {
        double rim_m = 0.01 * (scene->bounds_max_m[c] - scene->bounds_min_m[c]) + 1e-6;
        if (place_m[c] < scene->bounds_min_m[c] - rim_m || place_m[c] > scene->bounds_max_m[c] + rim_m)
            return false;
    }
    return true;
}

static double distance_to_bounds(const struct scene *scene, const double place_m[3])
{
    double square = 0;
    for (int c = 0; c < 3; c++) {
        double away = fmax(fmax(scene->bounds_min_m[c] - place_m[c], place_m[c] - scene->bounds_max_m[c]), 0);
        square += away * away;
    }
    return sqrt(square);
}

/* Counts triangles outside the main part; call after the scene's bounds are set. */
static void count_outside(struct scene *scene, const struct gap_tri *tris, size_t count)
{
    struct scene_outside *outside = &scene->outside;
    outside->triangles = count;
    for (size_t t = 0; t < count; t++) {
        struct scene_asset *asset = &scene->assets[tris[t].owner];
        outside->assets += !asset->stray;
        asset->stray = true;
        for (int k = 0; k < 3; k++) {
            double away_m = distance_to_bounds(scene, tris[t].at[k]);
            if (away_m > asset->stray_away_m) {
                asset->stray_away_m = away_m;
                memcpy(asset->stray_at_m, tris[t].at[k], sizeof(asset->stray_at_m));
            }
            outside->away_m = fmax(outside->away_m, away_m);
        }
    }
}

static void log_outside(struct log *log, const struct scene *scene, size_t all)
{
    int logged = 0;
    for (size_t i = 0; i < scene->asset_count && logged < LOGGED_ASSETS; i++) {
        const struct scene_asset *asset = &scene->assets[i];
        if (!asset->stray)
            continue;
        logged++;
        log_warn(
            log,
            "the view of the whole plant leaves out a part of asset %s at %.7g, %.7g, %.7g, which lies %.3g m from the rest of the plant",
            scene->plant->assets[i].id, asset->stray_at_m[0], asset->stray_at_m[1], asset->stray_at_m[2], asset->stray_away_m);
    }
    log_warn(
        log,
        "the view of the whole plant leaves out %zu of %zu triangles, in %d asset%s: check models for stray vertices, and check placements",
        scene->outside.triangles, all, scene->outside.assets, scene->outside.assets == 1 ? "" : "s");
}

void main_part_find(struct log *log, struct scene *scene)
{
    struct scene_tris parts = { 0 };
    struct extent extent;
    size_t capacity = 0;
    for (size_t i = 0; i < scene->asset_count; i++)
        if (!scene->assets[i].missing)
            add_asset(&parts, scene, (int)i, &capacity);
    size_t kept = gap_split(parts.tris, parts.count, &extent);
    if (kept < parts.count) {
        memcpy(scene->bounds_min_m, extent.low, sizeof(scene->bounds_min_m));
        memcpy(scene->bounds_max_m, extent.high, sizeof(scene->bounds_max_m));
        count_outside(scene, parts.tris + kept, parts.count - kept);
        if (log)
            log_outside(log, scene, parts.count);
    }
    mem_free(parts.tris);
}
