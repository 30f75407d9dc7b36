/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the sensors' interpolation weights at a point, like server/field, but eight sensors at a time (SIMD). The weights at
 * a point sum to 1. Call from any thread. */
#ifndef PREPROCESS_SUBDIVISION_INTERP_WEIGHTS_H
#define PREPROCESS_SUBDIVISION_INTERP_WEIGHTS_H
#include <stdbool.h>
#include <stddef.h>

/* Sensor arrays are padded to a multiple of INTERP_LANES. Padding sensors have distance INFINITY, strength 0 and decay 1, and
 * therefore weight 0. */
#define INTERP_LANES 8
/* Returns `count` rounded up to a multiple of INTERP_LANES. */
static inline size_t interp_padded(size_t count)
{
    return (count + INTERP_LANES - 1) / INTERP_LANES * INTERP_LANES;
}

/* Writes the straight-line distances from the point to `count` positions, given as separate arrays of x, y and z. */
void interp_euclidean(const float point_m[3], const float *const places_m[3], size_t count, float *distance_m);
/* Returns the smallest of `count` numbers, for example of distances. */
float interp_least(const float *values, size_t count);

struct interp_group {
    const float *strength, *decay;
    bool decays; /* true: the decay of at least one sensor differs from 1 */
    /* power: exponent of inverse distance weights; reach_m: distance beyond which a sensor has no weight, INFINITY: no limit;
     * at a point out of all sensors' reach, the nearest one has all the weight */
    float power, reach_m;
    size_t count;
};
/* factors that convert Shepard weights relative to the nearest sensor's into weights that sum to 1 */
struct interp_norm {
    /* near_m: distance to the nearest sensor, metres; per: 1 / sum of the relative weights, INFINITY if no sensor is within
       reach (the group's maximum distance of influence) */
    float near_m, per;
};
/* Writes the inverse-distance (Shepard) weights of a group's sensors at a point to `interp`, and their normalisation to *norm.
 * With `slopes`, returns the largest change of the interpolated value per metre at the point, for any readings within the
 * range; otherwise returns 0. */
float interp_shepard(const struct interp_group *group, const float *distance_m, bool slopes, float *interp, struct interp_norm *norm);
/* Like interp_shepard(), but with the weights of Algorithm 1 of Kim & Suh (Electronics 2025, 14(15), 2938) and its radius R = radius_m.
 * Always returns the largest change per metre. */
float interp_paper(const struct interp_group *group, float radius_m, const float *distance_m, float *interp);

/* Computes only the normalisation of Shepard weights (1 / sum of the weights), for interp_shepard_again(). distance_m: group->count values
 * including padding. */
void interp_shepard_norm(const struct interp_group *group, const float *distance_m, struct interp_norm *norm);
/* Writes the same weights as interp_shepard(), in less than half the time, from the normalisation computed by
 * interp_shepard_norm() or interp_shepard(). */
void interp_shepard_again(const struct interp_group *group, const float *distance_m, const struct interp_norm *norm, float *interp);

/* Compares the sensors' weights `sample` at a point with the linear interpolation of the weights at the corners. Returns the
 * largest error of linear interpolation for any readings, as a share of the range (0 to 1): the larger of two sums, that of
 * the positive and that of the negative differences. */
float interp_error(const float *const *corners, const float *weights, size_t corner_count, const float *sample, size_t count);

#endif
