/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sums behind the sensors' shares, for eight sensors at a time. Thread: any. */
#ifndef PREPROCESS_SUBDIVISION_INTERP_WEIGHTS_H
#define PREPROCESS_SUBDIVISION_INTERP_WEIGHTS_H
#include <stdbool.h>
#include <stddef.h>

/* Counts are multiples of this; where there is no sensor, the distance is INFINITY, strength 0 and decay 1. Then the share is 0. */
#define INTERP_LANES 8
static inline size_t interp_padded(size_t count)
{
    return (count + INTERP_LANES - 1) / INTERP_LANES * INTERP_LANES;
}

/* Metres from the point to places, whose x, y and z lie apart. */
void interp_euclidean(const float point_m[3], const float *const places_m[3], size_t count, float *distance_m);
float interp_least(const float *values, size_t count);

struct interp_group {
    const float *strength, *decay;
    bool decays;          /* some decay is not 1 */
    float power, reach_m; /* INFINITY: no limit; where nobody reaches, the nearest has all of a value */
    size_t count;
};
struct interp_norm {   /* what makes shares of shepard's weights: these are parts of the nearest sensor's */
    float near_m, per; /* INFINITY: there is none within reach */
};
/* They return the most that a value changes over a metre there, whatever the readings: unless `slopes`, 0. */
float interp_shepard(const struct interp_group *group, const float *distance_m, bool slopes, float *interp, struct interp_norm *norm);
float interp_paper(const struct interp_group *group, float radius_m, const float *distance_m, float *interp);

void interp_shepard_norm(const struct interp_group *group, const float *distance_m, struct interp_norm *norm); /* it alone */
/* The same shares, in less than half the time. */
void interp_shepard_again(const struct interp_group *group, const float *distance_m, const struct interp_norm *norm, float *interp);

/* Shares at a point against those at corners, weighted: the sum of what is more, or of what is less, whichever is larger. */
float interp_error(const float *const *corners, const float *weights, size_t corner_count, const float *sample, size_t count);

#endif
