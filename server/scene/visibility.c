/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sets of assets as bit arrays, and section planes that cut a view. */
#include "scene/visibility.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "plant/plant.h"

static const double SLACK_M = 1e-3;
_Static_assert((int)PLANT_STARTS <= (int)ASSET_SET_MAX, "an asset_set must have room for all assets that can start hidden or as ghosts");

void asset_set_add(struct asset_set *set, int asset)
{
    assert(asset >= 0 && asset < ASSET_SET_MAX);
    set->count += !asset_set_has(set, asset);
    set->words[asset / 64] |= UINT64_C(1) << (asset % 64);
}

bool asset_set_has(const struct asset_set *set, int asset)
{
    return asset < ASSET_SET_MAX && (set->words[asset / 64] >> (asset % 64) & 1);
}

static bool set_equal(const struct asset_set *a, const struct asset_set *b)
{
    return a->count == b->count && (a->count == 0 || !memcmp(a->words, b->words, sizeof(a->words)));
}

void clip_box(struct clip *clip, const double min_m[3], const double max_m[3])
{
    *clip = (struct clip){ .plane_count = 6, .is_box = true };
    for (int i = 0; i < 3; i++) {
        clip->planes[2 * i][i] = 1;
        clip->planes[2 * i][3] = -min_m[i];
        clip->planes[2 * i + 1][i] = -1;
        clip->planes[2 * i + 1][3] = max_m[i];
    }
}

void clip_get_box(const struct clip *clip, double min_m[3], double max_m[3])
{
    for (int i = 0; i < 3; i++) {
        min_m[i] = -clip->planes[2 * i][3];
        max_m[i] = clip->planes[2 * i + 1][3];
    }
}

static double along(const double plane[4], const double v[3])
{
    return plane[0] * v[0] + plane[1] * v[1] + plane[2] * v[2];
}

void clip_plane(const struct clip *clip, int index, double out[4])
{
    memcpy(out, clip->planes[index], sizeof(clip->planes[index]));
    out[3] += SLACK_M;
}

bool clip_keeps(const struct clip *clip, const double point_m[3])
{
    for (int i = 0; i < clip->plane_count; i++)
        if (along(clip->planes[i], point_m) + clip->planes[i][3] < -SLACK_M)
            return false;
    return true;
}

/* Returns the signed height above a plane of one corner of the box: the corner farthest on the plane's inner side if `inward`
   is 1, or farthest on its outer side if it is -1. */
static double corner_height(const double plane[4], const double min_m[3], const double max_m[3], int inward)
{
    double height = plane[3] + SLACK_M;
    for (int i = 0; i < 3; i++)
        height += plane[i] * (plane[i] * inward > 0 ? max_m[i] : min_m[i]);
    return height;
}

bool clip_drops(const struct clip *clip, const double min_m[3], const double max_m[3])
{
    for (int i = 0; i < clip->plane_count; i++)
        if (corner_height(clip->planes[i], min_m, max_m, 1) < 0)
            return true;
    return false;
}

bool clip_touches(const struct clip *clip, const double min_m[3], const double max_m[3])
{
    for (int i = 0; i < clip->plane_count; i++)
        if (corner_height(clip->planes[i], min_m, max_m, -1) < 0)
            return true;
    return false;
}

bool clip_ray(const struct clip *clip, const double origin[3], const double direction[3], double *low, double *high)
{
    for (int i = 0; i < clip->plane_count; i++) {
        double height = along(clip->planes[i], origin) + clip->planes[i][3] + SLACK_M, rise = along(clip->planes[i], direction);
        if (rise > 0)
            *low = fmax(*low, -height / rise);
        else if (rise < 0)
            *high = fmin(*high, -height / rise);
        else if (height < 0)
            return false;
    }
    return *low <= *high;
}

enum asset_look visibility_of(const struct visibility *visibility, int asset)
{
    if (asset_set_has(&visibility->hidden, asset))
        return ASSET_HIDDEN;
    if (asset_set_has(&visibility->ghosts, asset))
        return ASSET_GHOST;
    return visibility->isolated.count > 0 && !asset_set_has(&visibility->isolated, asset) ? ASSET_HIDDEN : ASSET_SHOWN;
}

void visibility_start(const struct plant *plant, struct visibility *out)
{
    *out = (struct visibility){ 0 };
    for (size_t i = 0; i < plant->asset_count; i++)
        if (plant->assets[i].start != PLANT_START_SHOWN)
            asset_set_add(plant->assets[i].start == PLANT_START_GHOST ? &out->ghosts : &out->hidden, (int)i);
}

bool visibility_equal(const struct visibility *a, const struct visibility *b)
{
    size_t planes = (size_t)a->clip.plane_count;
    return set_equal(&a->hidden, &b->hidden) && set_equal(&a->isolated, &b->isolated) && set_equal(&a->ghosts, &b->ghosts) &&
           a->clip.plane_count == b->clip.plane_count && a->clip.is_box == b->clip.is_box &&
           !memcmp(a->clip.planes, b->clip.planes, planes * sizeof(a->clip.planes[0]));
}
