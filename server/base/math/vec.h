/* SPDX-License-Identifier: GPL-3.0-or-later */
/* 3-vectors in double precision; functions whose names begin with vecf take single precision. Call from any thread. */
#ifndef BASE_MATH_VEC_H
#define BASE_MATH_VEC_H
#include <math.h>

/* Returns the smaller of two numbers that are not NaN. Replaces fmin() and fmax() of the C library: calls of these functions,
   which also handle NaN, would take up half the time of a ray query. */
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

/* Cross product. `out` must be neither `a` nor `b`. */
static inline void vec_cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Computes (b - a) x (c - a). Its length is twice the area of triangle a, b, c; it points to the side from which a, b, c run
   counter-clockwise. */
static inline void vec_normal(const double a[3], const double b[3], const double c[3], double out[3])
{
    double ab[3], ac[3];
    vec_sub(b, a, ab);
    vec_sub(c, a, ac);
    vec_cross(ab, ac, out);
}

static inline double vec_length(const double a[3])
{
    return sqrt(vec_dot(a, a));
}

/* Divides a vector by its length, and returns the length; leaves the zero vector unchanged. */
static inline double vec_normalize(double v[3])
{
    double length = vec_length(v);
    for (int i = 0; i < 3 && length > 0; i++)
        v[i] /= length;
    return length;
}

/* Computes two unit vectors x, y orthogonal to each other and to the unit vector `normal`, so that x, y, normal are
   right-handed. Equal input gives equal bits (Duff et al., Building an orthonormal basis, revisited, JCGT 2017). */
static inline void vec_frame(const double normal[3], double x[3], double y[3])
{
    double sign = copysign(1, normal[2]), a = -1 / (sign + normal[2]), b = normal[0] * normal[1] * a;
    x[0] = 1 + sign * normal[0] * normal[0] * a;
    x[1] = sign * b;
    x[2] = -sign * normal[0];
    y[0] = b;
    y[1] = sign + normal[1] * normal[1] * a;
    y[2] = -normal[1];
}

/* Rotates v, a tangent vector of the plane with unit normal `from`, into the plane with normal `to` by the smallest rotation.
   The signs of the normals do not matter. */
static inline void vec_turn(double v[3], const double from[3], const double to[3])
{
    double sign = copysign(1, vec_dot(from, to)), part = sign * vec_dot(to, v) / (1 + sign * vec_dot(from, to));
    for (int i = 0; i < 3; i++)
        v[i] -= part * (from[i] + sign * to[i]);
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

/* Returns the distance of a point from the segment a-b. */
static inline double vec_segment_distance(const double p[3], const double a[3], const double b[3])
{
    double ab[3], ap[3], at[3];
    vec_sub(b, a, ab);
    vec_sub(p, a, ap);
    double along = vec_dot(ap, ab) / max_of(vec_dot(ab, ab), 1e-300);
    vec_mix(a, b, min_of(max_of(along, 0), 1), at);
    return vec_distance(p, at);
}

/* --- single precision ------------------------------------------------------------------------------------------------------------ */

/* Computes a - b from single-precision vectors; the result has double precision. */
static inline void vecf_sub(const float a[3], const float b[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = (double)a[i] - (double)b[i];
}

static inline float vecf_distance(const float a[3], const float b[3])
{
    float x = b[0] - a[0], y = b[1] - a[1], z = b[2] - a[2];
    return sqrtf(x * x + y * y + z * z);
}
static inline float vecf_dot(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Like vec_normal(), for points in single precision; the result is computed in double precision. */
static inline void vecf_normal(const float a[3], const float b[3], const float c[3], double out[3])
{
    double ab[3], ac[3];
    vecf_sub(b, a, ab);
    vecf_sub(c, a, ac);
    vec_cross(ab, ac, out);
}

#endif
