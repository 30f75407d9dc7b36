/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fits the rotation between two point sets as an eigenvector, found by power iteration. */
#include "preprocess/geometry/rigid_fit.h"

#include <math.h>
#include <string.h>

#include "plant/models/transform.h"

enum { POWER_STEPS = 2000 };

static void middle_of(const double (*points)[3], size_t count, double middle[3])
{
    memset(middle, 0, 3 * sizeof(*middle));
    for (size_t i = 0; i < count; i++)
        for (int axis = 0; axis < 3; axis++)
            middle[axis] += points[i][axis] / (double)count;
}

/* Builds Horn's matrix, whose eigenvector with the largest eigenvalue is the rotation as a quaternion. */
static void horn_matrix(const double (*from)[3], const double (*to)[3], size_t count, const double from_middle[3],
                        const double to_middle[3], double n[4][4])
{
    double s[3][3] = { { 0 } };
    for (size_t v = 0; v < count; v++)
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                s[i][j] += (from[v][i] - from_middle[i]) * (to[v][j] - to_middle[j]);
    const double m[4][4] = {
        { s[0][0] + s[1][1] + s[2][2], s[1][2] - s[2][1], s[2][0] - s[0][2], s[0][1] - s[1][0] },
        { s[1][2] - s[2][1], s[0][0] - s[1][1] - s[2][2], s[0][1] + s[1][0], s[2][0] + s[0][2] },
        { s[2][0] - s[0][2], s[0][1] + s[1][0], -s[0][0] + s[1][1] - s[2][2], s[1][2] + s[2][1] },
        { s[0][1] - s[1][0], s[2][0] + s[0][2], s[1][2] + s[2][1], -s[0][0] - s[1][1] + s[2][2] },
    };
    memcpy(n, m, sizeof(m));
}

/* Finds the eigenvector of the largest eigenvalue by power iteration. First shifts all eigenvalues so that the largest one is
 * also the largest in magnitude. */
static void largest_eigenvector(double n[4][4], double q[4])
{
    double shift = 0;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            shift += fabs(n[i][j]);
    for (int i = 0; i < 4; i++) {
        n[i][i] += shift;
        q[i] = 0.5 + 0.1 * i;
    }
    for (int step = 0; step < POWER_STEPS; step++) {
        double next[4] = { 0 }, length = 0;
        for (int i = 0; i < 4; i++) {
            for (int j = 0; j < 4; j++)
                next[i] += n[i][j] * q[j];
            length += next[i] * next[i];
        }
        length = sqrt(length);
        for (int i = 0; i < 4; i++)
            q[i] = length > 0 ? next[i] / length : q[i];
    }
}

void rigid_fit(const double (*from)[3], const double (*to)[3], size_t count, double motion[16])
{
    double from_middle[3], to_middle[3], n[4][4], q[4], turned[3];
    middle_of(from, count, from_middle);
    middle_of(to, count, to_middle);
    horn_matrix(from, to, count, from_middle, to_middle, n);
    largest_eigenvector(n, q);
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double turn[16] = { 1 - 2 * (y * y + z * z),
                              2 * (x * y + w * z),
                              2 * (x * z - w * y),
                              0,
                              2 * (x * y - w * z),
                              1 - 2 * (x * x + z * z),
                              2 * (y * z + w * x),
                              0,
                              2 * (x * z + w * y),
                              2 * (y * z - w * x),
                              1 - 2 * (x * x + y * y),
                              0,
                              0,
                              0,
                              0,
                              1 };
    memcpy(motion, turn, sizeof(turn));
    transform_point(turn, from_middle, turned);
    for (int axis = 0; axis < 3; axis++)
        motion[12 + axis] = to_middle[axis] - turned[axis];
}
