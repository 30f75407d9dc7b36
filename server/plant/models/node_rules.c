/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes and checks the transforms of glTF nodes. */
#include "plant/models/node_rules.h"

#include <math.h>
#include <string.h>

#include "plant/models/transform.h"

/* MAX_COORDINATE: largest magnitude of a number in a matrix; LEAST_ROTATION: smallest length of a rotation's quaternion;
   MATRIX_SLACK: tolerated deviation of a matrix's last row from 0, 0, 0, 1 */
static const double MAX_COORDINATE = 1e15, LEAST_ROTATION = 1e-6, MATRIX_SLACK = 1e-6;

const char *node_rules_local(const double t[3], const double q[4], const double s[3], const double *matrix, double out[16])
{
    if (!(sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]) >= LEAST_ROTATION))
        return "the node's rotation in the glTF file is invalid: its quaternion has length 0, expected 1";
    transform_compose_quaternion(t, q, s, out);
    if (matrix)
        memcpy(out, matrix, 16 * sizeof(*out));
    for (int column = 0; column < 4; column++) {
        if (!(fabs(out[4 * column + 3] - (column == 3)) <= MATRIX_SLACK))
            return "the node's matrix in the glTF file is invalid: its last row is not 0 0 0 1";
        out[4 * column + 3] = column == 3;
    }
    return node_rules_world(out);
}

const char *node_rules_world(const double m[16])
{
    for (int i = 0; i < 16; i++)
        if (!(fabs(m[i]) <= MAX_COORDINATE))
            return "the node's transformation in the glTF file has numbers that are infinite, invalid or above 1e15";
    return NULL;
}

const char *node_rules_shape(bool has_mesh, bool has_skin, bool has_morph_weights)
{
    return has_mesh && has_skin ? "Plantcast does not support skinned meshes: export the model without skins"
           : has_morph_weights  ? "Plantcast does not support morph targets: export the model without them"
                                : NULL;
}
