/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "approach.h"

#include <math.h>
#include <string.h>

#include "base/vec.h"

static const double MAX_ELEVATION_DEG = 89;          /* straight up or down the horizon has no direction */
static const double turns_deg[APPROACH_SIDES][2] = { /* about the vertical, up */
                                                     { 0, 0 },    { 35, 0 },    { -35, 0 }, { 0, 30 },   { 70, 0 },    { -70, 0 },
                                                     { 35, 30 },  { -35, 30 },  { 0, 55 },  { 110, 0 },  { -110, 0 },  { 0, -20 },
                                                     { 145, 0 },  { -145, 0 },  { 180, 0 }, { 70, 30 },  { -70, 30 },  { 180, 30 },
                                                     { 50, -20 }, { -50, -20 }, { 0, -45 }, { 90, -45 }, { -90, -45 }, { 180, -45 }
};

const double approach_around[APPROACH_AROUND][2] = { { -0.12, 0 },   { 0.12, 0 },   { 0, -0.12 },  { 0, 0.12 },
                                                     { -0.2, -0.2 }, { 0.2, -0.2 }, { -0.2, 0.2 }, { 0.2, 0.2 } };

/* Rodrigues: turned by an angle about a unit axis, right-handed. */
static void turn(double v[3], const double axis[3], double angle)
{
    double c = cos(angle), s = sin(angle), along = vec_dot(axis, v) * (1 - c), across[3];
    vec_cross(axis, v, across);
    for (int i = 0; i < 3; i++)
        v[i] = c * v[i] + s * across[i] + along * axis[i];
}

struct camera approach_camera(const struct camera *first, const double place_m[3], int side)
{
    struct camera camera = *first;
    double right[3], up[3], forward[3], vertical[3];
    camera_basis(first, right, up, forward);
    memcpy(vertical, first->up, sizeof(vertical));
    vec_normalize(vertical);
    double before_deg = asin(fmax(-1, fmin(1, -vec_dot(forward, vertical)))) * 180 / M_PI,
           limit_deg = fmax(MAX_ELEVATION_DEG, fabs(before_deg));
    double tilt_deg = fmax(-limit_deg, fmin(limit_deg, before_deg + turns_deg[side][1])) - before_deg;
    double *const ends[] = { camera.eye_m, camera.target_m };
    for (int end = 0; end < 2; end++) {
        double from_m[3];
        vec_sub(ends[end], place_m, from_m);
        turn(from_m, right, -tilt_deg * M_PI / 180);
        turn(from_m, vertical, turns_deg[side][0] * M_PI / 180);
        for (int i = 0; i < 3; i++)
            ends[end][i] = place_m[i] + from_m[i];
    }
    return camera;
}
