/* SPDX-License-Identifier: GPL-3.0-or-later */
/* 4x4 matrices of doubles, column-major: plant coordinates are too large for 32-bit floats. */
#ifndef RENDER_MATRIX_H
#define RENDER_MATRIX_H

void matrix_identity(double out[16]);
/* writes the product a b (b is applied first) to out, which may be a or b */
void matrix_multiply(const double a[16], const double b[16], double out[16]);
void matrix_translation(const double by[3], double out[16]);
void matrix_point(const double m[16], const double p[3], double out[4]);
/* Inverts a matrix, which may contain a perspective projection. The matrix must not be singular. */
void matrix_invert(const double m[16], double out[16]);
/* Writes the matrix that transforms normals if m transforms points: the inverse transpose of the 3x3 part of m, column-major. */
void matrix_normals(const double m[16], float out[9]);
/* Transforms a plane (n . p + d = 0, given as n.x, n.y, n.z, d). The matrix m maps points from the result's coordinates to the plane's. */
void matrix_plane(const double m[16], const double plane[4], float out[4]);
void matrix_to_float(const double m[16], float out[16]);
/* Writes the orthographic projection that fits a sphere, seen from infinity along `towards`. Depth in clip space is 1 at the sphere's point
   nearest to the viewer, 0 at the farthest. */
void matrix_parallel(const double center[3], double radius, const double towards[3], double out[16]);
/* Writes a matrix that applies `clip` and then maps clip space to texture coordinates, with rows from the top (GL_UPPER_LEFT). */
void matrix_texture_from_clip(const double clip[16], double out[16]);

#endif
