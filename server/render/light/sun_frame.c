/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fits the sun's frustum around all assets as seen from the sun. Rotates it about the sun's direction so that its longer side
   is as short as possible. */
#include "render/light/sun_frame.h"

#include <math.h>

#include "base/math/vec.h"
#include "render/matrix.h"

/* number of rotations around the sun's direction, within a quarter turn, tried to find the smallest frustum */
enum { TRIED_ANGLES = 32 };

struct sun_extent {
    /* bounds of the assets that cast shadows, in metres from the scene's centre: across and up as seen from the sun, and towards the sun */
    double low[3], high[3];
};

static void axes_of(const double towards[3], double turn, double axes[3][3])
{
    double side[3], up[3], most = fabs(towards[2]) < 0.9, c = cos(turn), s = sin(turn);
    double helper[3] = { 1 - most, 0, most };
    vec_cross(helper, towards, side);
    vec_normalize(side);
    vec_cross(towards, side, up);
    for (int i = 0; i < 3; i++) {
        axes[0][i] = c * side[i] + s * up[i];
        axes[1][i] = c * up[i] - s * side[i];
        axes[2][i] = towards[i];
    }
}

static void add_box(struct sun_extent *extent, const double axes[3][3], const double middle_m[3], const struct scene_asset *asset)
{
    for (int a = 0; a < 3; a++) {
        double low = 0, high = 0;
        for (int i = 0; i < 3; i++) {
            double one = axes[a][i] * (asset->bounds_min_m[i] - middle_m[i]), other = axes[a][i] * (asset->bounds_max_m[i] - middle_m[i]);
            low += fmin(one, other);
            high += fmax(one, other);
        }
        extent->low[a] = fmin(extent->low[a], low);
        extent->high[a] = fmax(extent->high[a], high);
    }
}

static struct sun_extent extent_of(const struct gpu_scene *gpu_scene, const double axes[3][3], const struct visibility *shown)
{
    struct sun_extent extent = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
    for (size_t i = 0; i < gpu_scene->scene->asset_count; i++) {
        const struct scene_asset *asset = &gpu_scene->scene->assets[i];
        if (visibility_of(shown, (int)i) == ASSET_SHOWN && !clip_drops(&shown->clip, asset->bounds_min_m, asset->bounds_max_m))
            add_box(&extent, axes, gpu_scene->middle_m, asset);
    }
    for (int a = 0; a < 3; a++)
        if (!(extent.low[a] < extent.high[a])) { /* nothing casts a shadow */
            extent.low[a] = -gpu_scene->radius_m;
            extent.high[a] = gpu_scene->radius_m;
        }
    return extent;
}

static double longer_side(const struct sun_extent *extent)
{
    return fmax(extent->high[0] - extent->low[0], extent->high[1] - extent->low[1]);
}

void sun_frame_fit(struct sun_frame *frame, const struct gpu_scene *gpu_scene, const double towards[3], const struct visibility *shown,
                   double margin)
{
    double best[3][3], axes[3][3];
    struct sun_extent extent = { 0 };
    for (int turn = 0; turn < TRIED_ANGLES; turn++) {
        axes_of(towards, turn * M_PI_2 / TRIED_ANGLES, axes);
        struct sun_extent tried = extent_of(gpu_scene, (const double(*)[3])axes, shown);
        if (turn > 0 && longer_side(&tried) >= longer_side(&extent))
            continue;
        extent = tried;
        for (int i = 0; i < 9; i++)
            best[i / 3][i % 3] = axes[i / 3][i % 3];
    }
    double margin_m = margin * longer_side(&extent);
    matrix_identity(frame->clip_from_plant);
    for (int a = 0; a < 3; a++) {
        double low = extent.low[a] - margin_m, high = extent.high[a] + margin_m, scale = (a == 2 ? 1 : 2) / (high - low);
        frame->clip_from_plant[12 + a] = (a == 2 ? 0 : -1) - low * scale;
        for (int i = 0; i < 3; i++) {
            frame->clip_from_plant[4 * i + a] = best[a][i] * scale;
            frame->clip_from_plant[12 + a] -= best[a][i] * scale * gpu_scene->middle_m[i];
        }
    }
    frame->width_m = longer_side(&extent) + 2 * margin_m;
    frame->depth_m = extent.high[2] - extent.low[2] + 2 * margin_m;
}
