/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes interpolation weights and sums over sensors, eight sensors at a time (SIMD). */
#include "preprocess/subdivision/interp_weights.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "base/math/simd.h"

#define L INTERP_LANES
#define MIN_M 1e-5f    /* distance in metres below which a sensor gets all the weight at a point */
#define MIN_EXP -87.0f /* arguments of exp() are raised to at least this; below, a single-precision result would be denormal */
/* minimum nearness (1 at a sensor, 0 at the radius) used for the weight's slopes: with a decay below 1, the slope would be
 * infinite at the radius */
#define MIN_NEARNESS 1e-3f

typedef float lanes __attribute__((vector_size(4 * L)));
typedef int32_t mask __attribute__((vector_size(4 * L))); /* a mask with one lane per sensor, whose bits are all set or all clear */

SIMD_BODY void load(const float *from, lanes *to)
{
    memcpy(to, from, sizeof(*to));
}

SIMD_BODY void store(const lanes *from, float *to)
{
    memcpy(to, from, sizeof(*from));
}

SIMD_BODY void keep(const mask *which, lanes *x) /* keeps the lanes of *x whose mask is set, and zeroes the others */
{
    *x = (lanes)(*which & (mask)*x);
}

SIMD_BODY void take_less(const lanes *x, lanes *least)
{
    mask less = *x < *least;
    *least = (lanes)((less & (mask)*x) | (~less & (mask)*least));
}

SIMD_BODY void take_more(const lanes *x, lanes *most)
{
    mask more = *x > *most;
    *most = (lanes)((more & (mask)*x) | (~more & (mask)*most));
}

SIMD_BODY float sum_of(const lanes *x)
{
    float sum = 0;
    for (int i = 0; i < L; i++)
        sum += (*x)[i];
    return sum;
}

/* --- distances ---------------------------------------------------------------------------------------------------------------- */

SIMD_BODY void euclidean(const float point_m[3], const float *const places_m[3], size_t count, float *distance_m)
{
    for (size_t i = 0; i < count; i += L) {
        lanes sum = { 0 }, place;
        for (int axis = 0; axis < 3; axis++) {
            load(places_m[axis] + i, &place);
            place -= point_m[axis];
            sum += place * place;
        }
        for (int l = 0; l < L; l++)
            sum[l] = sqrtf(sum[l]);
        store(&sum, distance_m + i);
    }
}

SIMD_BODY float least(const float *values, size_t count)
{
    lanes low = (lanes){ 0 } + INFINITY, x;
    for (size_t i = 0; i < count; i += L) {
        load(values + i, &x);
        take_less(&x, &low);
    }
    for (int l = 1; l < L; l++)
        low[0] = low[l] < low[0] ? low[l] : low[0];
    return low[0];
}

/* --- shepard ------------------------------------------------------------------------------------------------------------------ */

SIMD_BODY void raise_lanes(lanes *x, float power)
{
    lanes base = *x;
    if (power == 2)
        *x = base * base;
    else if (power == 3)
        *x = base * base * base;
    else if (power != 1)
        for (int l = 0; l < L; l++)
            (*x)[l] = powf(base[l], power);
}

/* Fades a sensor's weight smoothly to 0 towards the group's reach (distance beyond which a sensor has no influence). Multiplies
   the weight by the square of (reach - distance) / (reach - distance of the nearest sensor). Beyond the reach the weight is 0;
   only the nearest sensor's stays 1. */
SIMD_BODY void fade(const struct interp_group *group, float near_m, const lanes *far, lanes *weight)
{
    const lanes zero = { 0 }, near = zero + near_m;
    float own_m = group->reach_m - near_m;
    mask nearest = *far <= near;
    lanes one = zero + 1, left = (group->reach_m - *far) * (own_m > 0 ? 1 / own_m : 0);
    mask within = left > zero;
    keep(&within, &left);
    left = (lanes)((nearest & (mask)one) | (~nearest & (mask)(left * left)));
    *weight *= left;
}

/* Computes Shepard weights (power of the inverse distance) relative to the nearest sensor's weight, so that no power overflows a float. */
SIMD_BODY void shepard_weight(const struct interp_group *group, size_t i, float near_m, const float *distance_m, lanes *weight)
{
    const lanes floor_m = (lanes){ 0 } + MIN_M;
    lanes far, strength;
    load(distance_m + i, &far);
    load(group->strength + i, &strength);
    take_more(&floor_m, &far);
    *weight = near_m / far;
    raise_lanes(weight, group->power);
    *weight *= strength;
    if (group->reach_m < INFINITY)
        fade(group, near_m, &far, weight);
}

/* Computes the relative decrease of a weight per metre of distance that is due to its fade towards the reach (distance beyond
   which a sensor has no influence): 2 / (reach - distance). */
SIMD_BODY void per_left(const struct interp_group *group, const lanes *far, lanes *out)
{
    const lanes least_m = (lanes){ 0 } + MIN_M;
    lanes left = group->reach_m - *far;
    take_more(&least_m, &left);
    *out = 2 / left;
}

SIMD_BODY float shepard_slope(const struct interp_group *group, const float *distance_m, const float *interp)
{
    const lanes floor_m = (lanes){ 0 } + MIN_M;
    lanes slope = { 0 }, fading = { 0 }, far, weight;
    for (size_t i = 0; i < group->count; i += L) {
        load(distance_m + i, &far);
        load(interp + i, &weight);
        take_more(&floor_m, &far);
        slope += weight * (1 - weight) / far;
        if (group->reach_m < INFINITY) {
            per_left(group, &far, &far);
            fading += weight * (1 - weight) * far;
        }
    }
    return group->power * sum_of(&slope) + sum_of(&fading);
}

SIMD_BODY float shepard(const struct interp_group *group, const float *distance_m, bool slopes, float *interp, struct interp_norm *norm)
{
    lanes sum = { 0 }, weight;
    float near_m = least(distance_m, group->count);
    *norm = (struct interp_norm){ .near_m = near_m < MIN_M ? MIN_M : near_m };
    if (near_m == INFINITY) {
        memset(interp, 0, group->count * sizeof(*interp));
        return 0;
    }
    for (size_t i = 0; i < group->count; i += L) {
        shepard_weight(group, i, norm->near_m, distance_m, &weight);
        sum += weight;
        store(&weight, interp + i);
    }
    float total = sum_of(&sum);
    norm->per = total > 0 ? 1 / total : 0;
    for (size_t i = 0; i < group->count; i += L) {
        load(interp + i, &weight);
        weight *= norm->per;
        store(&weight, interp + i);
    }
    return slopes ? shepard_slope(group, distance_m, interp) : 0;
}

SIMD_BODY void shepard_norm(const struct interp_group *group, const float *distance_m, struct interp_norm *norm)
{
    lanes sum = { 0 }, weight;
    float near_m = least(distance_m, group->count);
    *norm = (struct interp_norm){ .near_m = near_m < MIN_M ? MIN_M : near_m };
    for (size_t i = 0; i < group->count && near_m < INFINITY; i += L) {
        shepard_weight(group, i, norm->near_m, distance_m, &weight);
        sum += weight;
    }
    float total = sum_of(&sum);
    norm->per = total > 0 ? 1 / total : 0;
}

SIMD_BODY void shepard_again(const struct interp_group *group, const float *distance_m, const struct interp_norm *norm, float *interp)
{
    lanes weight;
    for (size_t i = 0; i < group->count && norm->near_m < INFINITY; i += L) {
        shepard_weight(group, i, norm->near_m, distance_m, &weight);
        weight *= norm->per;
        store(&weight, interp + i);
    }
    if (norm->near_m == INFINITY)
        memset(interp, 0, group->count * sizeof(*interp));
}

/* --- paper -------------------------------------------------------------------------------------------------------------------- */

/* Computes exp for arguments up to 0, as 2^n times a polynomial, with a relative error of about 2e-7. */
SIMD_BODY void exponential(lanes *x)
{
    const lanes lowest = (lanes){ 0 } + MIN_EXP;
    take_more(&lowest, x);
    lanes halves = *x * 1.44269504f - 0.5f;
    /* converting to an integer truncates towards 0; here it rounds to nearest, because the number is at most 0 and 0.5 has been
     * subtracted */
    mask n = __builtin_convertvector(halves, mask);
    lanes whole = __builtin_convertvector(n, lanes), r = *x - whole * 0.693359375f + whole * 2.12194440e-4f, p;
    p = 1.3888889e-3f * r + 8.3333333e-3f;
    p = p * r + 4.1666667e-2f;
    p = p * r + 1.6666667e-1f;
    p = p * r + 0.5f;
    p = p * r + 1;
    p = p * r + 1;
    *x = p * (lanes)((n + 127) << 23);
}

struct softmax {
    /* per_m: 1 / radius of Algorithm 1, in 1/m; largest: largest exponent of any sensor, which is subtracted from all exponents
       so that exp() cannot overflow */
    float per_m, largest;
    /* distance to the nearest sensor, metres; used only if the group has a reach (distance beyond which a sensor has no weight) */
    float near_m;
};

/* Computes the nearness of sensors: 1 at a sensor, falling to 0 at the radius of Algorithm 1 of Kim & Suh, and 0 beyond. */
SIMD_BODY void nearness(const float *distance_m, float per_m, lanes *out)
{
    const lanes zero = { 0 };
    load(distance_m, out);
    *out = 1 - *out * per_m;
    take_more(&zero, out);
}

/* Computes the softmax weights of Algorithm 1 of Kim & Suh before division by their sum, and the nearness of each sensor (1 at
   the sensor, 0 at the algorithm's radius). */
SIMD_BODY void paper_weight(const struct interp_group *group, size_t i, const struct softmax *softmax, const float *distance_m, lanes *near,
                            lanes *weight)
{
    const lanes infinite = (lanes){ 0 } + INFINITY;
    lanes strength, far;
    load(distance_m + i, &far);
    mask reached = far < infinite;
    nearness(distance_m + i, softmax->per_m, near);
    load(group->strength + i, &strength);
    *weight = *near * strength - softmax->largest;
    exponential(weight);
    keep(&reached, weight);
    if (group->reach_m < INFINITY)
        fade(group, softmax->near_m, &far, weight);
}

/* Returns the largest change of the value interpolated by Algorithm 1 of Kim & Suh, as a share of the value range, if the
   nearness of each sensor changes by at most 1. Nearness is 1 at the sensor and 0 at the radius. A sensor changes its own term
   of the value through its weight and its decay. It also changes the terms of the others, whose weights sum to 1 minus its own.
   Sensors beyond the radius change nothing. */
SIMD_BODY float paper_slope(const struct interp_group *group, const struct softmax *softmax, const float *distance_m, float per,
                            const float *interp, float all)
{
    const lanes zero = { 0 }, least_near = (lanes){ 0 } + MIN_NEARNESS;
    lanes sum = { 0 }, near, weight, strength, decay, share, far;
    for (size_t i = 0; i < group->count; i += L) {
        paper_weight(group, i, softmax, distance_m, &near, &weight);
        load(group->strength + i, &strength);
        load(group->decay + i, &decay);
        load(interp + i, &share);
        mask within = near > zero;
        if (group->reach_m < INFINITY) {
            load(distance_m + i, &far);
            within |= weight > zero;
            per_left(group, &far, &far);
            strength += far / softmax->per_m;
        }
        take_more(&least_near, &near);
        weight *= per;
        lanes own = strength * share * (1 - weight) + decay * share / near, others = strength * weight * (all - share);
        take_more(&others, &own);
        keep(&within, &own);
        sum += own;
    }
    return sum_of(&sum);
}

SIMD_BODY float paper(const struct interp_group *group, float radius_m, const float *distance_m, float *interp)
{
    lanes high = { 0 }, sum = { 0 }, valued = { 0 }, d, weight, strength, far;
    struct softmax softmax = { .per_m = 1 / radius_m, .near_m = INFINITY };
    if (group->reach_m < INFINITY) {
        softmax.near_m = least(distance_m, group->count);
        softmax.near_m = softmax.near_m < MIN_M ? MIN_M : softmax.near_m;
    }
    for (size_t i = 0; i < group->count; i += L) {
        nearness(distance_m + i, softmax.per_m, &d);
        load(group->strength + i, &strength);
        weight = d * strength;
        if (group->reach_m < INFINITY) {
            load(distance_m + i, &far);
            mask in = (far < group->reach_m) | (far <= softmax.near_m);
            keep(&in, &weight);
        }
        take_more(&weight, &high);
    }
    softmax.largest = high[0];
    for (int l = 1; l < L; l++)
        softmax.largest = high[l] > softmax.largest ? high[l] : softmax.largest;
    for (size_t i = 0; i < group->count; i += L) {
        paper_weight(group, i, &softmax, distance_m, &d, &weight);
        sum += weight;
        for (int l = 0; l < L && group->decays; l++)
            d[l] = powf(d[l], group->decay[i + (size_t)l]);
        weight *= d;
        valued += weight;
        store(&weight, interp + i);
    }
    float total = sum_of(&sum), per = total > 0 ? 1 / total : 0;
    for (size_t i = 0; i < group->count; i += L) {
        load(interp + i, &weight);
        weight *= per;
        store(&weight, interp + i);
    }
    return softmax.per_m * paper_slope(group, &softmax, distance_m, per, interp, per * sum_of(&valued));
}

/* --- errors ------------------------------------------------------------------------------------------------------------------- */

SIMD_BODY float error_of(const float *const *corners, const float *weights, size_t corner_count, const float *sample, size_t count)
{
    const lanes zero = { 0 };
    lanes above = { 0 }, below = { 0 }, at, x;
    for (size_t i = 0; i < count; i += L) {
        load(sample + i, &x);
        for (size_t c = 0; c < corner_count; c++) {
            load(corners[c] + i, &at);
            x -= weights[c] * at;
        }
        mask more = x > zero;
        at = x;
        keep(&more, &at);
        above += at;
        below += at - x;
    }
    float most = sum_of(&above), least = sum_of(&below);
    return most > least ? most : least;
}

/* --- function variants for wider SIMD registers ----------------------------------------------------------------------------------- */

SIMD_AVX2 static void euclidean_wide(const float point_m[3], const float *const places_m[3], size_t count, float *distance_m)
{
    euclidean(point_m, places_m, count, distance_m);
}

SIMD_AVX2 static float least_wide(const float *values, size_t count)
{
    return least(values, count);
}

SIMD_AVX2 static float shepard_wide(const struct interp_group *group, const float *distance_m, bool slopes, float *interp,
                                    struct interp_norm *norm)
{
    return shepard(group, distance_m, slopes, interp, norm);
}

SIMD_AVX2 static void shepard_norm_wide(const struct interp_group *group, const float *distance_m, struct interp_norm *norm)
{
    shepard_norm(group, distance_m, norm);
}

SIMD_AVX2 static void shepard_again_wide(const struct interp_group *group, const float *distance_m, const struct interp_norm *norm,
                                         float *interp)
{
    shepard_again(group, distance_m, norm, interp);
}

SIMD_AVX2 static float paper_wide(const struct interp_group *group, float radius_m, const float *distance_m, float *interp)
{
    return paper(group, radius_m, distance_m, interp);
}

SIMD_AVX2 static float error_wide(const float *const *corners, const float *weights, size_t corner_count, const float *sample, size_t count)
{
    return corner_count == 2 ? error_of(corners, weights, 2, sample, count) : error_of(corners, weights, corner_count, sample, count);
}

void interp_euclidean(const float point_m[3], const float *const places_m[3], size_t count, float *distance_m)
{
    if (simd_has_avx2())
        euclidean_wide(point_m, places_m, count, distance_m);
    else
        euclidean(point_m, places_m, count, distance_m);
}

float interp_least(const float *values, size_t count)
{
    return simd_has_avx2() ? least_wide(values, count) : least(values, count);
}

float interp_shepard(const struct interp_group *group, const float *distance_m, bool slopes, float *interp, struct interp_norm *norm)
{
    return simd_has_avx2() ? shepard_wide(group, distance_m, slopes, interp, norm) : shepard(group, distance_m, slopes, interp, norm);
}

void interp_shepard_norm(const struct interp_group *group, const float *distance_m, struct interp_norm *norm)
{
    if (simd_has_avx2())
        shepard_norm_wide(group, distance_m, norm);
    else
        shepard_norm(group, distance_m, norm);
}

void interp_shepard_again(const struct interp_group *group, const float *distance_m, const struct interp_norm *norm, float *interp)
{
    if (simd_has_avx2())
        shepard_again_wide(group, distance_m, norm, interp);
    else
        shepard_again(group, distance_m, norm, interp);
}

float interp_paper(const struct interp_group *group, float radius_m, const float *distance_m, float *interp)
{
    return simd_has_avx2() ? paper_wide(group, radius_m, distance_m, interp) : paper(group, radius_m, distance_m, interp);
}

float interp_error(const float *const *corners, const float *weights, size_t corner_count, const float *sample, size_t count)
{
    return simd_has_avx2() ? error_wide(corners, weights, corner_count, sample, count)
                           : error_of(corners, weights, corner_count, sample, count);
}
