/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finned motors and coupling guards. */
#include "machine.h"

#include "shape.h"

void machine_motor(struct item *item, struct frame at, double r, double length, double feet)
{
    struct mesh *body = item_part(item, "motor", MATERIAL_MOTOR);
    const double cowl = length * 0.22, fin = r * 0.11;
    const bool small = r < 0.2; /* seen from afar only */
    const int sides = small ? 16 : 36;
    struct profile profile = { 0 };
    profile_edge(&profile, r * 0.18, -0.02);
    profile_edge(&profile, r * 0.30, 0.0);
    profile_edge(&profile, r * 0.42, 0.02);
    profile_edge(&profile, r * 0.96, 0.04 * length);
    profile_edge(&profile, r * 1.02, 0.06 * length);
    profile_edge(&profile, r * 1.02, 0.12 * length);
    profile_edge(&profile, r * 0.90, 0.12 * length);
    profile_edge(&profile, r * 0.90, length - cowl - 0.05 * length);
    profile_edge(&profile, r * 1.02, length - cowl - 0.05 * length);
    profile_edge(&profile, r * 1.02, length - cowl);
    profile_edge(&profile, r * 1.05, length - cowl);
    profile_edge(&profile, r * 1.05, length - cowl * 0.25);
    profile_smooth(&profile, r * 0.98, length - cowl * 0.06);
    profile_edge(&profile, r * 0.80, length);
    shape_revolve(body, at, &profile, sides, small ? 0 : r * 0.22);
    shape_cylinder(item_part(item, "grilles", MATERIAL_BLACK), frame_moved(at, 0, 0, length - 0.02), r * 0.82, 0.018, sides, 0);
    for (int i = 0; i < sides && !small; i++) {
        double deg = 360.0 * (i + 0.5) / sides;
        if (fabs(deg - 180.0) < 28.0) /* the feet are there */
            continue;
        shape_block(body, frame_turned(at, deg), r * 0.88, r * 0.90 + fin, -0.004, 0.004, 0.12 * length, length - cowl - 0.05 * length);
    }
    for (int i = -1; i <= 1; i += 2)
        shape_block(body, at, -feet, -r * 0.6, i * r * 0.75 - r * 0.2, i * r * 0.75 + r * 0.2, 0.16 * length, 0.66 * length);
    shape_block(body, at, r * 0.1, r * 0.8, r * 0.8, r * 1.45, 0.30 * length, 0.55 * length); /* terminal box */
    struct frame eye = frame_facing(frame_point(&at, vec(r * 1.08, 0, length * 0.42)), at.y, at.x);
    shape_torus(body, eye, r * 0.14, r * 0.04, 0, 360, 12, 6);
}

void machine_guard(struct item *item, struct frame at, double r, double length, double down)
{
    struct mesh *guard = item_part(item, "coupling guard", MATERIAL_SAFETY_YELLOW);
    shape_sector(guard, at, r - 0.006, r, 0, length, -90, 90, 14);
    for (int i = -1; i <= 1; i += 2)
        shape_block(guard, at, -down, 0.0, i * r - 0.003, i * r + 0.003, 0, length);
    shape_cylinder(item_part(item, "shaft", MATERIAL_STAINLESS), frame_moved(at, 0, 0, -0.03), r * 0.25, length + 0.06, 12, 0);
}
