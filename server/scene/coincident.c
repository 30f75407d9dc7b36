/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds large triangles of two assets that lie in one plane and overlap. */
#include "scene/coincident.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "plant/models/transform.h"

/* two faces count as coplanar if the distance of their planes is at most SAME_PLANE_M metres and the components of their unit
   normals differ by at most SAME_NORMAL; both follow from the accuracy of CAD positions stored as floats */
static const double SAME_PLANE_M = 2e-4, SAME_NORMAL = 1e-3;
static const double MIN_AREA_M2 = 1e-4, MIN_OVERLAP_M = 1e-3;
/* shift of an asset towards the viewer per step of its rank, as a fraction of its distance. It exceeds the depth error of
   frames for surfaces seen at an angle of 6 degrees or more, with positions rounded to 1/256 pixel */
static const double SHIFT_PER_STEP = 4e-5;
enum { MAX_STEPS = 7 };

struct coincident_face {
    /* unit normal, with its sign chosen so that the largest component is positive: both orientations of a face then compare equal */
    double normal[3];
    double offset_m; /* distance of the face's plane from the centre of the region where two assets meet */
    double corner[3][3], low[3], high[3];
};
struct faces {
    struct coincident_face *at;
    size_t count, capacity;
};
struct region {
    double low[3], high[3];
};

static bool boxes_meet(const double low_a[3], const double high_a[3], const double low_b[3], const double high_b[3])
{
    for (int c = 0; c < 3; c++)
        if (low_a[c] > high_b[c] + SAME_PLANE_M || low_b[c] > high_a[c] + SAME_PLANE_M)
            return false;
    return true;
}

static void turn(double normal[3])
{
    int most = fabs(normal[1]) > fabs(normal[0]) ? 1 : 0;
    most = fabs(normal[2]) > fabs(normal[most]) ? 2 : most;
    for (int c = 0; c < 3 && normal[most] < 0; c++)
        normal[c] = -normal[c];
}

/* Computes the face's normal and offset. Returns false if the triangle is too small to matter. */
static bool measure(struct coincident_face *face)
{
    double ab[3], ac[3];
    for (int c = 0; c < 3; c++) {
        ab[c] = face->corner[1][c] - face->corner[0][c];
        ac[c] = face->corner[2][c] - face->corner[0][c];
        face->low[c] = fmin(face->corner[0][c], fmin(face->corner[1][c], face->corner[2][c]));
        face->high[c] = fmax(face->corner[0][c], fmax(face->corner[1][c], face->corner[2][c]));
    }
    for (int c = 0; c < 3; c++)
        face->normal[c] = ab[(c + 1) % 3] * ac[(c + 2) % 3] - ab[(c + 2) % 3] * ac[(c + 1) % 3];
    double twice = sqrt(face->normal[0] * face->normal[0] + face->normal[1] * face->normal[1] + face->normal[2] * face->normal[2]);
    if (!(twice > 2 * MIN_AREA_M2))
        return false;
    for (int c = 0; c < 3; c++)
        face->normal[c] /= twice;
    turn(face->normal);
    return true;
}

/* Collects the asset's faces in the region, from the coarsest level, which has the fewest triangles in flat areas. */
static void collect(const struct scene_asset *asset, const struct region *region, struct faces *out)
{
    const struct asset_view *view = &asset->file->view;
    const struct asset_level *level = &view->levels[view->header->level_count - 1];
    out->count = 0;
    for (uint32_t p = 0; p < level->primitive_count; p++) {
        const struct asset_primitive *primitive = &view->primitives[level->first_primitive + p];
        for (uint32_t i = 0; i < primitive->index_count; i += 3) {
            struct coincident_face face = { .offset_m = 0 };
            for (int k = 0; k < 3; k++) {
                const float *place = view->positions_m[view->indices[primitive->first_index + i + (uint32_t)k]];
                transform_point(asset->placement, (double[3]){ (double)place[0], (double)place[1], (double)place[2] }, face.corner[k]);
            }
            if (!measure(&face) || !boxes_meet(face.low, face.high, region->low, region->high))
                continue;
            for (int c = 0; c < 3; c++)
                face.offset_m += face.normal[c] * (face.corner[0][c] - 0.5 * (region->low[c] + region->high[c]));
            mem_grow(&out->at, &out->capacity, out->count + 1, sizeof(*out->at));
            out->at[out->count++] = face;
        }
    }
}

static int by_offset(const void *a, const void *b)
{
    const struct coincident_face *x = a, *y = b;
    return (x->offset_m > y->offset_m) - (x->offset_m < y->offset_m);
}

static bool over_each_other(const struct coincident_face *a, const struct coincident_face *b)
{
    int wide = 0;
    for (int c = 0; c < 3; c++) {
        double overlap_m = fmin(a->high[c], b->high[c]) - fmax(a->low[c], b->low[c]);
        if (overlap_m < -SAME_PLANE_M)
            return false;
        wide += overlap_m > MIN_OVERLAP_M;
    }
    return wide >= 2;
}

static bool on_one_plane(const struct coincident_face *a, const struct coincident_face *b)
{
    for (int c = 0; c < 3; c++)
        if (fabs(a->normal[c] - b->normal[c]) > SAME_NORMAL)
            return false;
    for (int k = 0; k < 3; k++) {
        double away_m = 0;
        for (int c = 0; c < 3; c++)
            away_m += a->normal[c] * (b->corner[k][c] - a->corner[0][c]);
        if (fabs(away_m) > SAME_PLANE_M)
            return false;
    }
    return true;
}

/* Returns whether a face of one asset coincides with a face of the other. If their planes are only nearly parallel, the
   permitted difference of offsets grows with the angle times the region's size. */
static bool coincide(const struct faces *a, const struct faces *b, const struct region *region)
{
    double slack_m = SAME_PLANE_M;
    for (int c = 0; c < 3; c++)
        slack_m += SAME_NORMAL * (region->high[c] - region->low[c]);
    for (size_t i = 0, first = 0; i < a->count; i++) {
        while (first < b->count && b->at[first].offset_m < a->at[i].offset_m - slack_m)
            first++;
        for (size_t j = first; j < b->count && b->at[j].offset_m <= a->at[i].offset_m + slack_m; j++)
            if (over_each_other(&a->at[i], &b->at[j]) && on_one_plane(&a->at[i], &b->at[j]))
                return true;
    }
    return false;
}

static bool meet(const struct scene_asset *a, const struct scene_asset *b, struct faces faces[2])
{
    struct region region;
    if (!boxes_meet(a->bounds_min_m, a->bounds_max_m, b->bounds_min_m, b->bounds_max_m))
        return false;
    for (int c = 0; c < 3; c++) {
        region.low[c] = fmax(a->bounds_min_m[c], b->bounds_min_m[c]);
        region.high[c] = fmin(a->bounds_max_m[c], b->bounds_max_m[c]);
    }
    collect(a, &region, &faces[0]);
    if (faces[0].count == 0)
        return false;
    collect(b, &region, &faces[1]);
    if (faces[1].count == 0)
        return false;
    for (int i = 0; i < 2; i++)
        qsort(faces[i].at, faces[i].count, sizeof(*faces[i].at), by_offset);
    return coincide(&faces[0], &faces[1], &region);
}

/* Assigns ranks (scene_asset.front) to assets, from back to front. An asset gets a higher rank than all earlier assets that it
   has coincident faces with, up to MAX_STEPS. */
void coincident_find(struct scene *scene)
{
    struct faces faces[2] = { 0 };
    int *order = mem_array(scene->asset_count, sizeof(*order));
    size_t count = 0;
    for (int with_sensors = 0; with_sensors < 2; with_sensors++)
        for (size_t i = scene->asset_count; i-- > 0;)
            if ((scene->assets[i].sensor_count > 0) == with_sensors)
                order[count++] = (int)i;
    for (size_t i = 0; i < count; i++) {
        struct scene_asset *asset = &scene->assets[order[i]];
        asset->front = 0;
        for (size_t k = 0; k < i; k++) {
            const struct scene_asset *behind = &scene->assets[order[k]];
            if (behind->front >= asset->front && asset->front < MAX_STEPS && meet(asset, behind, faces))
                asset->front = behind->front < MAX_STEPS ? behind->front + 1 : MAX_STEPS;
        }
    }
    mem_free(order);
    mem_free(faces[0].at);
    mem_free(faces[1].at);
}

double coincident_forward(const struct scene_asset *asset)
{
    return SHIFT_PER_STEP * asset->front;
}
