/* SPDX-License-Identifier: GPL-3.0-or-later */
/* 4x4 matrix arithmetic in double precision. */
#include "render/matrix.h"

#include <math.h>
#include <string.h>

#include "base/math/vec.h"

void matrix_identity(double out[16])
{
    for (int i = 0; i < 16; i++)
        out[i] = i % 5 == 0;
}

void matrix_multiply(const double a[16], const double b[16], double out[16])
{
    double m[16];
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 4; r++)
            m[4 * c + r] = a[r] * b[4 * c] + a[4 + r] * b[4 * c + 1] + a[8 + r] * b[4 * c + 2] + a[12 + r] * b[4 * c + 3];
    memcpy(out, m, sizeof(m));
}

void matrix_translation(const double by[3], double out[16])
{
    matrix_identity(out);
    memcpy(out + 12, by, 3 * sizeof(double));
}

void matrix_point(const double m[16], const double p[3], double out[4])
{
    for (int r = 0; r < 4; r++)
        out[r] = m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r];
}

/* Inverts by Gauss-Jordan elimination; the pivot is the largest element of each column. */
void matrix_invert(const double m[16], double out[16])
{
    double a[4][8];
    for (int r = 0; r < 4; r++)
        for (int c = 0; c < 4; c++) {
            a[r][c] = m[4 * c + r];
            a[r][4 + c] = r == c;
        }
    for (int c = 0; c < 4; c++) {
        int pivot = c;
        for (int r = c + 1; r < 4; r++)
            if (fabs(a[r][c]) > fabs(a[pivot][c]))
                pivot = r;
        for (int k = 0; k < 8; k++) {
            double swap = a[c][k];
            a[c][k] = a[pivot][k];
            a[pivot][k] = swap;
        }
        double factor = 1 / a[c][c];
        for (int k = 0; k < 8; k++)
            a[c][k] *= factor;
        for (int r = 0; r < 4; r++) {
            double by = a[r][c];
            for (int k = 0; k < 8 && r != c; k++)
                a[r][k] -= by * a[c][k];
        }
    }
    for (int r = 0; r < 4; r++)
        for (int c = 0; c < 4; c++)
            out[4 * c + r] = a[r][4 + c];
}

void matrix_normals(const double m[16], float out[9])
{
    double columns[3][3];
    vec_cross(m + 4, m + 8, columns[0]);
    vec_cross(m + 8, m, columns[1]);
    vec_cross(m, m + 4, columns[2]);
    double determinant = vec_dot(m, columns[0]);
    for (int c = 0; c < 3; c++)
        for (int r = 0; r < 3; r++)
            out[3 * c + r] = (float)(columns[c][r] * (determinant < 0 ? -1 : 1));
}

void matrix_plane(const double m[16], const double plane[4], float out[4])
{
    for (int c = 0; c < 4; c++)
        out[c] = (float)(plane[0] * m[4 * c] + plane[1] * m[4 * c + 1] + plane[2] * m[4 * c + 2] + plane[3] * m[4 * c + 3]);
}

void matrix_to_float(const double m[16], float out[16])
{
    for (int i = 0; i < 16; i++)
        out[i] = (float)m[i];
}

void matrix_parallel(const double center[3], double radius, const double towards[3], double out[16])
{
    double helper[3] = { fabs(towards[2]) < 0.9 ? 0 : 1, 0, fabs(towards[2]) < 0.9 ? 1 : 0 }, side[3], up[3];
    vec_cross(helper, towards, side);
    vec_normalize(side);
    vec_cross(towards, side, up);
    matrix_identity(out);
    out[14] = 0.5;
    for (int i = 0; i < 3; i++) {
        out[4 * i] = side[i] / radius;
        out[4 * i + 1] = up[i] / radius;
        out[4 * i + 2] = 0.5 * towards[i] / radius;
        out[12] -= out[4 * i] * center[i];
        out[13] -= out[4 * i + 1] * center[i];
        out[14] -= out[4 * i + 2] * center[i];
    }
}

void matrix_texture_from_clip(const double clip[16], double out[16])
{
    static const double texture[16] = { 0.5, 0, 0, 0, 0, -0.5, 0, 0, 0, 0, 1, 0, 0.5, 0.5, 0, 1 };
    matrix_multiply(texture, clip, out);
}
