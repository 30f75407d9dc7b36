/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Splits the triangles at gaps along the axes, found in histograms of their corners. */
#include "scene/main_part.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "base/vec.h"
#include "plant/transform.h"

enum { BINS = 256, SPLITS_MOST = 64 };
static const double SMALL_SHARE = 0.02;             /* of the area: this much may be left out */
static const double SMALL_GAP = 1, LARGE_GAP = 100; /* sizes of the main part: gaps behind which a small or a large piece is left out */

struct tri {
    double at[3][3], area_m2;
    int asset;
};

struct parts {
    struct tri *tris;
    size_t count;
};

static void add_asset(struct parts *parts, const struct scene *scene, int asset, size_t *capacity)
{
    const struct scene_asset *of = &scene->assets[asset];
    const struct asset_view *view = &of->file->view;
    const struct asset_level *level = &view->levels[view->header->level_count - 1];
    for (uint32_t p = level->first_primitive; p < level->first_primitive + level->primitive_count; p++)
        for (uint32_t i = 0; i < view->primitives[p].index_count; i += 3) {
            struct tri tri = { .asset = asset };
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

static void box_of(const struct tri *tris, size_t count, double min_m[3], double max_m[3])
{
    for (int c = 0; c < 3; c++) {
        min_m[c] = INFINITY;
        max_m[c] = -INFINITY;
        for (size_t t = 0; t < count; t++)
            for (int k = 0; k < 3; k++) {
                min_m[c] = fmin(min_m[c], tris[t].at[k][c]);
                max_m[c] = fmax(max_m[c], tris[t].at[k][c]);
            }
    }
}

static double size_of(const struct tri *tris, size_t count)
{
    double min_m[3], max_m[3], size_m = 0;
    box_of(tris, count, min_m, max_m);
    for (int c = 0; c < 3; c++)
        size_m = fmax(size_m, max_m[c] - min_m[c]);
    return size_m;
}

/* Finds the widest gap along an axis. Returns its length; 0: there is none. */
static double find_gap(const struct parts *parts, int axis, double min_m, double max_m, double *from_m, double *to_m)
{
    struct {
        double low_m, high_m;
    } bins[BINS];
    double last_m = min_m, gap_m = 0;
    if (!(max_m > min_m))
        return 0;
    for (int b = 0; b < BINS; b++)
        bins[b].low_m = INFINITY, bins[b].high_m = -INFINITY;
    for (size_t t = 0; t < parts->count; t++)
        for (int k = 0; k < 3; k++) {
            double x = parts->tris[t].at[k][axis];
            int b = (int)fmin(BINS * ((x - min_m) / (max_m - min_m)), BINS - 1);
            bins[b].low_m = fmin(bins[b].low_m, x);
            bins[b].high_m = fmax(bins[b].high_m, x);
        }
    for (int b = 0; b < BINS; b++) {
        if (!(bins[b].low_m <= bins[b].high_m))
            continue;
        if (bins[b].low_m - last_m > gap_m) {
            gap_m = bins[b].low_m - last_m;
            *from_m = last_m;
            *to_m = bins[b].low_m;
        }
        last_m = bins[b].high_m;
    }
    return gap_m;
}

static void swap(struct tri *a, struct tri *b)
{
    struct tri copy = *a;
    *a = *b;
    *b = copy;
}

/* Moves triangles of the side (below or above the gap) to the front. Returns how many lie there whole. */
static size_t gather(struct parts *parts, int axis, double from_m, double to_m, bool above, double *area_m2)
{
    size_t count = 0;
    *area_m2 = 0;
    for (size_t t = 0; t < parts->count; t++) {
        int inside = 0;
        for (int k = 0; k < 3; k++)
            inside += above ? parts->tris[t].at[k][axis] >= to_m : parts->tris[t].at[k][axis] <= from_m;
        if (inside < 3)
            continue;
        *area_m2 += parts->tris[t].area_m2;
        swap(&parts->tris[t], &parts->tris[count++]);
    }
    return count;
}

/* Leaves out what is behind a gap. Returns whether there was one. */
static bool split(struct parts *parts, double all_m2)
{
    double min_m[3], max_m[3];
    box_of(parts->tris, parts->count, min_m, max_m);
    for (int axis = 0; axis < 3; axis++) {
        double from_m, to_m, low_m2, high_m2;
        double gap_m = find_gap(parts, axis, min_m[axis], max_m[axis], &from_m, &to_m);
        if (!(gap_m > 0))
            continue;
        size_t low = gather(parts, axis, from_m, to_m, false, &low_m2), high = gather(parts, axis, from_m, to_m, true, &high_m2);
        bool above = high_m2 > low_m2 || (high_m2 == low_m2 && high > low);
        size_t kept = gather(parts, axis, from_m, to_m, above, &low_m2);
        double size_m = size_of(parts->tris, kept), lost_m2 = all_m2 - low_m2;
        if (kept > 0 && size_m > 0 && gap_m >= (lost_m2 <= SMALL_SHARE * all_m2 ? SMALL_GAP : LARGE_GAP) * size_m) {
            parts->count = kept;
            return true;
        }
    }
    return false;
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

/* After the bounds are known. */
static void count_outside(struct log *log, struct scene *scene, const struct parts *parts, size_t all)
{
    struct scene_outside *outside = &scene->outside;
    int first = -1;
    for (size_t t = parts->count; t < all; t++) {
        outside->triangles++;
        scene->assets[parts->tris[t].asset].stray = true;
        first = first < 0 || parts->tris[t].asset < first ? parts->tris[t].asset : first;
        for (int k = 0; k < 3; k++)
            outside->away_m = fmax(outside->away_m, distance_to_bounds(scene, parts->tris[t].at[k]));
    }
    for (size_t i = 0; i < scene->asset_count; i++)
        outside->assets += scene->assets[i].stray;
    if (log && first >= 0)
        log_warn(log,
                 "first view: %zu of %zu triangles lie up to %.3g m from the rest and are not in it (%d assets, the first is %s); check "
                 "the model for stray vertices",
                 outside->triangles, all, outside->away_m, outside->assets, scene->plant->assets[first].id);
}

void main_part_find(struct log *log, struct scene *scene)
{
    struct parts parts = { 0 };
    size_t capacity = 0;
    double all_m2 = 0;
    for (size_t i = 0; i < scene->asset_count; i++)
        if (!scene->assets[i].missing)
            add_asset(&parts, scene, (int)i, &capacity);
    for (size_t t = 0; t < parts.count; t++)
        all_m2 += parts.tris[t].area_m2;
    const size_t all = parts.count;
    int splits = 0;
    while (splits < SPLITS_MOST && parts.count > 0 && split(&parts, all_m2))
        splits++;
    if (splits > 0) {
        box_of(parts.tris, parts.count, scene->bounds_min_m, scene->bounds_max_m);
        count_outside(log, scene, &parts, all);
    }
    mem_free(parts.tris);
}
