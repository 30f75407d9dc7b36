/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Affine transforms (rotation, translation, scale) in double precision, 4x4, column-major: out = m * (x, y, z, 1). Call from any thread. */
#ifndef PLANT_MODELS_TRANSFORM_H
#define PLANT_MODELS_TRANSFORM_H
#include <stdbool.h>

extern const double transform_identity[16];

/* Multiplies two transforms: out = a * b. `out` must be neither `a` nor `b`. */
void transform_multiply(const double a[16], const double b[16], double out[16]);
/* Composes translate * Rz * Ry * Rx: rotates about x, then y, then z, then translates. */
void transform_compose(const double translate[3], const double rotate_deg[3], double out[16]);
/* Composes translate * rotate * scale as glTF does; the quaternion (x, y, z, w) may have any length. */
void transform_compose_quaternion(const double t[3], const double q[4], const double s[3], double out[16]);
/* Inverts an affine transform (last row 0 0 0 1). `out` must not be `m`. Returns false, with `out` unchanged, if the transform has no
   inverse. */
bool transform_invert(const double m[16], double out[16]);
void transform_point(const double m[16], const double point[3], double out[3]);

#endif
