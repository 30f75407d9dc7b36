/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the sensors' interpolation weights at a point as server/field does, eight sensors at a time (SIMD). Weights at a point add up to
   1. Thread: any. */
#ifndef PREPROCESS_SUBDIVISION_INTERP_WEIGHTS_H
#define PREPROCESS_SUBDIVISION_INTERP_WEIGHTS_H
#include <stdbool.h>
#include <stddef.h>

/* Counts are multiples of this; padding has distance INFINITY, strength 0 and decay 1, which gives weight 0. */
#define INTERP_LANES 8
/* Returns `count` rounded up to a multiple of INTERP_LANES. */
static inline size_t interp_padded(size_t count)
{
    return (count + INTERP_LANES - 1) / INTERP_LANES * INTERP_LANES;
}

/* Writes the straight-line distances from the point to `count` positions, whose x, y and z are separate arrays. */
void interp_euclidean(const float point_m[3], const float *const places_m[3], size_t count, float *distance_m);
/* Returns the smallest of the values. */
float interp_least(const float *values, size_t count);

struct interp_group {
    const float *strength, *decay;
    bool decays;          /* some decay is not 1 */
    float power, reach_m; /* INFINITY: no limit; where nobody reaches, the nearest has all of a value */
    size_t count;
};
/* What turns Shepard weights relative to the nearest sensor's into weights that add up to 1. */
struct interp_norm {
    float near_m, per; /* INFINITY: there is none within reach */
};
/* Writes the inverse-distance (Shepard) weights of a group's sensors to `interp`, and their normalisation to *norm. Returns, if `slopes`,
   the largest change of the interpolated value per metre there, for any readings within the range; else 0. */
float interp_shepard(const struct interp_group *group, const float *distance_m, bool slopes, float *interp, struct interp_norm *norm);
/* As interp_shepard(), by Algorithm 1 of the paper with radius radius_m. */
float interp_paper(const struct interp_group *group, float radius_m, const float *distance_m, float *interp);

/* Computes only the normalisation of Shepard weights, for interp_shepard_again(). distance_m: group->count of them, padding included. */
void interp_shepard_norm(const struct interp_group *group, const float *distance_m, struct interp_norm *norm);
/* Writes the same weights as interp_shepard(), given their normalisation, in less than half the time. */
void interp_shepard_again(const struct interp_group *group, const float *distance_m, const struct interp_norm *norm, float *interp);

/* Compares weights at a point with the combination of those at corners: returns the sum of positive differences or of negative ones,
   whichever is larger. That is the largest error of a linear interpolation, in parts of the range. */
float interp_error(const float *const *corners, const float *weights, size_t corner_count, const float *sample, size_t count);

#endif
