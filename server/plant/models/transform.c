/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Affine transforms. */
#include "plant/models/transform.h"

#include <math.h>
#include <string.h>

const double transform_identity[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };

void transform_multiply(const double a[16], const double b[16], double out[16])
{
    for (int column = 0; column < 4; column++)
        for (int row = 0; row < 4; row++) {
            double sum = 0;
            for (int k = 0; k < 4; k++)
                sum += a[k * 4 + row] * b[column * 4 + k];
            out[column * 4 + row] = sum;
        }
}

/* Computes the sine and cosine of an angle in degrees. They are exact at multiples of a right angle, so that an asset is
   rotated exactly by a right angle. */
static void sin_cos_deg(double deg, double *sine, double *cosine)
{
    static const double sines[4] = { 0, 1, 0, -1 };
    double turn = fmod(deg, 360);
    double quarters = turn / 90;
    if (quarters == floor(quarters)) {
        int quarter = ((int)quarters + 4) % 4;
        *sine = sines[quarter];
        *cosine = sines[(quarter + 1) % 4];
        return;
    }
    *sine = sin(turn * M_PI / 180);
    *cosine = cos(turn * M_PI / 180);
}

void transform_compose(const double translate[3], const double rotate_deg[3], double out[16])
{
    double sx, cx, sy, cy, sz, cz;
    sin_cos_deg(rotate_deg[0], &sx, &cx);
    sin_cos_deg(rotate_deg[1], &sy, &cy);
    sin_cos_deg(rotate_deg[2], &sz, &cz);
    const double m[16] = {
        cz * cy, sz * cy, -sy, 0,
        cz * sy * sx - sz * cx, sz * sy * sx + cz * cx, cy * sx, 0,
        cz * sy * cx + sz * sx, sz * sy * cx - cz * sx, cy * cx, 0,
        translate[0], translate[1], translate[2], 1,
    };
    memcpy(out, m, sizeof(m));
}

void transform_compose_quaternion(const double t[3], const double q[4], const double s[3], double out[16])
{
    double x = q[0], y = q[1], z = q[2], w = q[3], n = x * x + y * y + z * z + w * w, k = n > 0 ? 2 / n : 0;
    const double r[9] = { 1 - k * (y * y + z * z), k * (x * y + w * z),     k * (x * z - w * y),
                          k * (x * y - w * z),     1 - k * (x * x + z * z), k * (y * z + w * x),
                          k * (x * z + w * y),     k * (y * z - w * x),     1 - k * (x * x + y * y) };
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < 3; i++)
            out[4 * c + i] = r[3 * c + i] * s[c];
    out[3] = out[7] = out[11] = 0;
    for (int i = 0; i < 3; i++)
        out[12 + i] = t[i];
    out[15] = 1;
}

bool transform_invert(const double m[16], double out[16])
{
    double a = m[5] * m[10] - m[9] * m[6], b = m[9] * m[2] - m[1] * m[10], c = m[1] * m[6] - m[5] * m[2];
    double determinant = m[0] * a + m[4] * b + m[8] * c;
    if (determinant == 0 || !isfinite(1 / determinant))
        return false;
    double f = 1 / determinant;
    const double inverse[16] = {
        f * a, f * b, f * c, 0,
        f * (m[8] * m[6] - m[4] * m[10]), f * (m[0] * m[10] - m[8] * m[2]), f * (m[4] * m[2] - m[0] * m[6]), 0,
        f * (m[4] * m[9] - m[8] * m[5]), f * (m[8] * m[1] - m[0] * m[9]), f * (m[0] * m[5] - m[4] * m[1]), 0,
        0, 0, 0, 1,
    };
    memcpy(out, inverse, sizeof(inverse));
    double moved[3];
    transform_point(inverse, &m[12], moved);
    for (int i = 0; i < 3; i++)
        out[12 + i] = -moved[i];
    return true;
}

void transform_point(const double m[16], const double point[3], double out[3])
{
    double x = point[0], y = point[1], z = point[2];
    for (int row = 0; row < 3; row++)
        out[row] = m[row] * x + m[4 + row] * y + m[8 + row] * z + m[12 + row];
}
