/* SPDX-License-Identifier: GPL-3.0-or-later */
/* 4x4 matrices in double, column-major, for places that 32-bit floats cannot hold. */
#ifndef RENDER_MATRIX_H
#define RENDER_MATRIX_H

void matrix_identity(double out[16]);
void matrix_multiply(const double a[16], const double b[16], double out[16]); /* a after b; out may be either */
void matrix_translation(const double by[3], double out[16]);
void matrix_point(const double m[16], const double p[3], double out[4]);
/* Of a matrix with perspective too. Not for singular ones. */
void matrix_invert(const double m[16], double out[16]);
/* How normals turn under m: inverse transpose of its 3x3 part, columns one after another. */
void matrix_normals(const double m[16], float out[9]);
/* A plane, n p + d, in the coordinates that m comes from. */
void matrix_plane(const double m[16], const double plane[4], float out[4]);
void matrix_to_float(const double m[16], float out[16]);
/* A map of a ball, seen from far away in the direction `towards`. Clip space: depth 1 nearest to where it is seen from, 0 farthest. */
void matrix_parallel(const double center[3], double radius, const double towards[3], double out[16]);
/* From clip space to texture coordinates, with rows from the top (GL_UPPER_LEFT). */
void matrix_texture_from_clip(const double clip[16], double out[16]);

#endif
