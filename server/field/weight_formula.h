/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The weight of one sensor at one point, by straight-line or surface distance. kernels.c uses these formulas for many vertices
   at a time, pixel_field.c for single points; render/soft/pixel_lanes.h has a SIMD version for squared distances. Branch-free,
   so that loops become SIMD code. All distances are in metres; near_m: distance of the nearest sensor. Pure. */
#ifndef FIELD_WEIGHT_FORMULA_H
#define FIELD_WEIGHT_FORMULA_H
#include <float.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "base/math/simd.h"

#define WEIGHT_TINY 1e-37f

/* Returns log2 of x, or of WEIGHT_TINY for smaller x; accurate to 1e-7, exactly 0 at 1. The limit is applied to integers: a
   limit on floats would split the loop into paths, which prevents SIMD. */
static inline float weight_log2(float x)
{
    int32_t bits, tiny = 0x02081cea; /* bits of WEIGHT_TINY */
    memcpy(&bits, &x, sizeof(bits));
    bits = bits > tiny ? bits : tiny;
    int32_t exponent = (bits - LOG2_SPLIT_BITS) >> 23;
    bits -= exponent * (1 << 23);
    memcpy(&x, &bits, sizeof(x));
    x -= 1.0f;
    float p;
    LOG2_POLYNOMIAL(p, x);
    return (float)exponent + x * p;
}

/* Returns 2^x for -2e6 <= x <= 0, with relative error 2e-7; exactly 1 at 0, exactly 0 below -126.5. For x from 0 to 2e6,
   returns some finite number. */
static inline float weight_exp2(float x)
{
    int32_t whole = (int32_t)(x - 0.5f);
    whole = whole > -127 ? whole : -127;
    whole = whole < 0 ? whole : 0;
    float f = x - (float)whole;
    float p;
    EXP2_POLYNOMIAL(p, f);
    int32_t bits = (whole + 127) * (1 << 23);
    float power;
    memcpy(&power, &bits, sizeof(power));
    return p * power;
}

static inline bool weight_takes_part(float distance_m, float near_m, float reach_m)
{
    bool within = distance_m < reach_m, nearest = distance_m <= near_m, finite = distance_m <= FLT_MAX;
    return (within | nearest) & finite;
}

/* Fades a weight towards the finite reach: multiplies it by the square of the remaining distance, relative to the nearest
   sensor's: ((reach - distance) / (reach - near))^2. */
static inline float weight_faded(float weight, float distance_m, float near_m, float reach_m)
{
    float left = (reach_m - distance_m) / (reach_m - near_m);
    left = distance_m <= near_m ? 1.0f : left;
    return weight_takes_part(distance_m, near_m, reach_m) ? weight * left * left : 0.0f;
}

/* Shepard: returns (near / distance)^power, as 2^(power (log2 near - log2 distance)), because divisions dominate the cost. */
static inline float weight_part(float distance_m, float near_m, float near_log2, float power)
{
    float part = weight_exp2(power * (near_log2 - weight_log2(distance_m)));
    part = near_m > WEIGHT_TINY ? part : 0.0f;
    return distance_m <= near_m ? 1.0f : part;
}

static inline float weight_part_squared(float distance_m, float near_m)
{
    float below_one = near_m / distance_m;
    float ratio = distance_m <= near_m ? 1.0f : below_one;
    return ratio * ratio;
}

/* Paper: returns log2(e) d strength, with d = max(0, (R - D) / R), D the distance and R the radius. *d receives d, which is
   exactly 0 at D = R; this matters because a small decay exponent amplifies small values. */
static inline float weight_exponent(float distance_m, float radius_m, float per_radius, float strength, float *d)
{
    float near_one = (radius_m - distance_m) * per_radius;
    *d = near_one > 0.0f ? near_one : 0.0f;
    return *d * (strength * 1.44269504f);
}

/* Interpolation paper (Algorithm 1 of Kim & Suh): returns 2^exponent * d^decay, for a decay other than 0. Returns 0 for d up to
   WEIGHT_TINY, where the logarithm is not exact. */
static inline float weight_raised(float exponent, float d, float decay)
{
    float raised = weight_exp2(exponent + decay * weight_log2(d));
    return d > WEIGHT_TINY ? raised : 0.0f;
}

#endif
