/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The saddles of horizontal vessels: wrapper plate, web, ribs, base plate, anchor bolts. */
#include "saddle.h"

#include "shape.h"

void saddle_build(struct mesh *mesh, double x, double axis_z, double base_z, double r)
{
    const double half = r * 0.88, wide = 0.11;
    struct frame axis = frame_facing(vec(x, 0, axis_z), vec(1, 0, 0), vec(0, 0, -1)); /* its x points down */
    shape_sector(mesh, axis, r - 0.01, r + 0.014, -wide - 0.04, wide + 0.04, -62, 62, 24);
    struct frame at = frame_at(x, 0, base_z);
    shape_block(mesh, at, -wide - 0.03, wide + 0.03, -half - 0.04, half + 0.04, 0, 0.025);
    double chord = axis_z - base_z - r * cos(RADIANS(58.0));
    for (int i = 0; i < 12; i++) { /* the web, cut to the shell */
        double y0 = -half + 2 * half * i / 12, y1 = y0 + half / 6, middle = (y0 + y1) / 2;
        double top = fabs(middle) < r * sin(RADIANS(60.0)) ? axis_z - base_z - sqrt(r * r - middle * middle) : chord;
        shape_block(mesh, at, -0.009, 0.009, y0, y1, 0.02, top + 0.03);
    }
    for (int i = -2; i <= 2; i++) {
        double y = half * 0.48 * i, top = axis_z - base_z - sqrt(fmax(0.0, r * r - y * y));
        shape_block(mesh, at, -wide, wide, y - 0.008, y + 0.008, 0.02, top + 0.02);
    }
    for (int i = -1; i <= 1; i += 2)
        shape_hexagon(mesh, frame_moved(at, wide * 0.6, i * (half - 0.04), 0), 0.022, 0.02, 0.075);
}
