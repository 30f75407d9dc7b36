/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Three doubles. */
#ifndef SURFACE_VEC_H
#define SURFACE_VEC_H
#include <math.h>

/* fmin and fmax without their rules for NaN: there is none here, and the calls cost half of a ray. */
static inline double min_of(double a, double b)
{
    return a < b ? a : b;
}

static inline double max_of(double a, double b)
{
    return a > b ? a : b;
}

static inline void vec_sub(const double a[3], const double b[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[i] - b[i];
}

static inline double vec_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void vec_cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static inline double vec_distance2(const double a[3], const double b[3])
{
    double d[3];
    vec_sub(a, b, d);
    return vec_dot(d, d);
}

static inline double vec_distance(const double a[3], const double b[3])
{
    return sqrt(vec_distance2(a, b));
}

static inline void vec_mix(const double a[3], const double b[3], double t, double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[i] + t * (b[i] - a[i]);
}

#endif
