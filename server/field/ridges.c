/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "field/ridges.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/mem.h"

/* Bound on the error of a distance inside a triangle in which paths from two sides meet: this fraction of the triangle's longest
   side times the sine of half of the angle between the paths. With 0.2, it was exceeded at 3 of 48,600 random places of
   along_truth_test, with 0.1 at 8, with 0.3 at none. */
#define RIDGE_PART 0.3f
/* relative error of stored distances that does not count as a ridge: rounding, and differences between the errors of neighbouring
   vertices. Marking another 1.5 % of the places with 5e-4 finds no other error. */
#define ROUNDING 2e-3f

struct ridge_triangle { /* shape of a triangle, with corner 0 as origin and the sides e to corner 1 and f to corner 2 */
    float ee, ef, ff, divisor, longest_m;
};

/* Returns the largest error of a distance inside a triangle. far_m: distances of its corners from one sensor. If all paths come from
   one side, a source in the triangle's plane fits these distances. Otherwise the corners' distances are too short for any such
   source: the fitting one lies off the plane, by the sine of half of the angle between the paths times the distance. */
static float ridge_error(const struct ridge_triangle *tri, const float far_m[3])
{
    const float a2 = far_m[0] * far_m[0], b = far_m[1], c = far_m[2], mean_m = (far_m[0] + b + c) / 3;
    const float se = 0.5f * (tri->ee + a2 - b * b), sf = 0.5f * (tri->ff + a2 - c * c);
    const float in_plane2 = (tri->ff * se * se - 2 * tri->ef * se * sf + tri->ee * sf * sf) / tri->divisor;
    const float rounding = 2 * ROUNDING * mean_m * tri->longest_m / sqrtf(tri->divisor);
    const float sine2 = (a2 - in_plane2) / (mean_m * mean_m) - rounding;
    return sine2 > 0 ? RIDGE_PART * tri->longest_m * sqrtf(fminf(sine2, 1)) : 0;
}

struct ridge_sums { /* sums over the sensors for one triangle; a sensor of weight w has the largest relative error c due to the ridge */
    float total, first, second; /* sums of w, of w c, and of w^2 c */
};

/* Triangles examined together by one thread, so that it unpacks the distances from a sensor in whole blocks of KERNEL_BLOCK
   vertices. */
struct ridge_group {
    const uint32_t *indices;
    size_t count, block_count;
    bool *blocks; /* [block_count]: whether a triangle has a corner in the block */
    float *far_m; /* distances of the vertices of these blocks from one sensor */
    struct ridge_triangle tris[RIDGE_GROUP];
    float near_m[RIDGE_GROUP]; /* distance of the nearest corner from a sensor; NAN: the triangle is left out */
    struct ridge_sums sums[RIDGE_GROUP];
};

static void ridge_triangle_init(struct ridge_triangle *tri, const float (*at)[3], const uint32_t corners[3])
{
    *tri = (struct ridge_triangle){ 0 };
    for (int c = 0; c < 3; c++) {
        float e = at[corners[1]][c] - at[corners[0]][c], f = at[corners[2]][c] - at[corners[0]][c];
        tri->ee += e * e, tri->ef += e * f, tri->ff += f * f;
    }
    tri->divisor = tri->ee * tri->ff - tri->ef * tri->ef;
    tri->longest_m = sqrtf(fmaxf(tri->ee, fmaxf(tri->ff, tri->ee + tri->ff - 2 * tri->ef)));
}

/* Sets the group to triangles begin..end-1 of the asset. */
static void ridge_group_set(struct ridge_group *group, const struct ridge_job *job, size_t begin, size_t end)
{
    const struct weights *weights = job->weights;
    const struct asset_view *file = &weights->layout->file->view;
    group->indices = file->indices + 3 * begin;
    group->count = end - begin;
    memset(group->blocks, 0, group->block_count * sizeof(*group->blocks));
    for (size_t i = 0; i < group->count; i++) {
        const uint32_t *corners = group->indices + 3 * i;
        struct ridge_triangle *tri = &group->tris[i];
        float near_m = fminf(weights->near_m[corners[0]], fminf(weights->near_m[corners[1]], weights->near_m[corners[2]]));
        bool open = job->errors[begin + i] < 1 && isfinite(near_m);
        ridge_triangle_init(tri, file->positions_m, corners);
        group->near_m[i] = open && tri->divisor > 0 ? fmaxf(near_m, 1e-6f) : NAN;
        group->sums[i] = (struct ridge_sums){ 0 };
        for (int k = 0; k < 3 && !isnan(group->near_m[i]); k++)
            group->blocks[corners[k] / KERNEL_BLOCK] = true;
    }
}

static float shepard_weight(float ratio, float power)
{
    return power == 2 ? ratio * ratio : powf(ratio, power);
}

/* Adds one sensor to the sums of the group's triangles. */
static void ridge_group_add(struct ridge_group *group, const struct weights *weights, uint32_t sensor)
{
    const bool paper = weights->interpolation == INTERPOLATION_PAPER;
    for (size_t block = 0; block < group->block_count; block++) {
        size_t at = block * KERNEL_BLOCK, left = weights->layout->vertex_count - at, count = left < KERNEL_BLOCK ? left : KERNEL_BLOCK;
        float *out = group->far_m + at;
        const float *far_m = group->blocks[block] ? layout_distances(weights->layout, weights->distance, sensor, at, count, out) : out;
        if (far_m != out)
            memcpy(out, far_m, count * sizeof(*out));
    }
    for (size_t i = 0; i < group->count; i++) {
        const uint32_t *corners = group->indices + 3 * i;
        const struct ridge_triangle *tri = &group->tris[i];
        float far_m[3], error_m;
        if (isnan(group->near_m[i]))
            continue;
        for (int k = 0; k < 3; k++)
            far_m[k] = group->far_m[corners[k]];
        const float mean_m = (far_m[0] + far_m[1] + far_m[2]) / 3;
        if (!(mean_m < weights->reach_m) || !(mean_m > 0))
            continue;
        const float weight = paper ? expf(weights->strength[sensor] * fmaxf(0, 1 - mean_m / weights->radius_m))
                                   : weights->strength[sensor] * shepard_weight(group->near_m[i] / mean_m, weights->power);
        error_m = mean_m < weights->radius_m || !paper ? ridge_error(tri, far_m) : 0;
        const float change = paper ? (1 + weights->strength[sensor]) * error_m / weights->radius_m : weights->power * error_m / mean_m;
        group->sums[i].total += weight;
        group->sums[i].first += weight * change;
        group->sums[i].second += weight * weight * change;
    }
}

/* Returns the error of values inside a triangle due to distances there that do not follow from those of its corners, for the
   worst readings: relative to the spread of the readings (paper: to the largest). */
static float ridge_error_of(const struct ridge_sums *sums, bool paper)
{
    if (!(sums->total > 0))
        return 0;
    const float error = paper ? sums->first / sums->total : sums->first / sums->total - sums->second / (sums->total * sums->total);
    /* marks the triangle also if the weights overflow, so that the error is NaN */
    return error <= 0.5f * STEP_OF_COLOR ? 0 : fminf(error, 1);
}

static void measure_group(struct ridge_group *group, const struct ridge_job *job, size_t begin, size_t end)
{
    const struct weights *weights = job->weights;
    ridge_group_set(group, job, begin, end);
    for (size_t m = 0; m < weights->member_count; m++)
        ridge_group_add(group, weights, weights->members[m]);
    for (size_t i = 0; i < group->count; i++)
        if (!isnan(group->near_m[i]))
            job->ridges[begin + i] = ridge_error_of(&group->sums[i], weights->interpolation == INTERPOLATION_PAPER);
}

void ridges_measure(const struct ridge_job *job, size_t begin, size_t end)
{
    struct ridge_group *group = mem_new(sizeof(*group));
    group->block_count = (job->weights->layout->vertex_count + KERNEL_BLOCK - 1) / KERNEL_BLOCK;
    group->blocks = mem_array(group->block_count, sizeof(*group->blocks));
    group->far_m = mem_try_array(group->block_count * KERNEL_BLOCK, sizeof(*group->far_m));
    for (size_t t = begin; t < end && !group->far_m; t++)
        job->ridges[t] = 1;
    for (size_t t = begin; t < end && group->far_m; t += RIDGE_GROUP)
        measure_group(group, job, t, end - t < RIDGE_GROUP ? end : t + RIDGE_GROUP);
    mem_free(group->blocks);
    mem_free(group->far_m);
    mem_free(group);
}
