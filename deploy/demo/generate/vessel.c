/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The horizontal reflux drum and the vertical knock-out drum. */
#include "equipment.h"
#include "fitting.h"
#include "saddle.h"
#include "shape.h"
#include "steel.h"

static void level_gauge(struct item *item, struct vec low, struct vec high, struct vec out)
{
    struct mesh *steel = item_part(item, "level gauge", MATERIAL_STAINLESS);
    struct vec a = vec_along(low, out, 0.28), b = vec_along(high, out, 0.28);
    shape_bar(steel, vec_along(low, out, -0.05), a, 0.022, 8);
    shape_bar(steel, vec_along(high, out, -0.05), b, 0.022, 8);
    shape_bar(steel, vec_along(a, vec(0, 0, 1), -0.12), vec_along(b, vec(0, 0, 1), 0.12), 0.034, 10);
    struct frame scale = frame_facing(a, vec_sub(b, a), out);
    shape_block(item_part(item, "scale", MATERIAL_SAFETY_YELLOW), scale, 0.03, 0.05, -0.03, 0.03, 0, vec_length(vec_sub(b, a)));
}

void drum_build(struct site *site, const char *name, struct frame at, double r, double length, double base_z)
{
    const double axis_z = base_z + r + 0.45, half = length / 2;
    const int sides = 64;
    struct item item = item_begin(&site->model, name, at);
    struct mesh *shell = item_part(&item, "shell", MATERIAL_VESSEL);
    item.necks = item_part(&item, "saddles and nozzles", MATERIAL_VESSEL);
    item.flanges = item_part(&item, "flanges", MATERIAL_BOLTING);
    struct profile profile = { 0 };
    profile_bowl(&profile, r, 0, r * 0.5, 14);
    for (int i = 1; i < 3; i++) { /* weld seams */
        profile_edge(&profile, r, length * i / 3 - 0.012);
        profile_smooth(&profile, r + 0.004, length * i / 3);
        profile_edge(&profile, r, length * i / 3 + 0.012);
    }
    profile_dome(&profile, r, length, r * 0.5, 14);
    shape_revolve(shell, frame_facing(vec(-half, 0, axis_z), vec(1, 0, 0), vec(0, 0, 1)), &profile, sides, 0.12);

    item_nozzle(&item, "N1", vec(-half + 0.45, 0, axis_z + r), vec(0, 0, 1), 0.110, 0.25);
    item_nozzle(&item, "N2", vec(half - 0.55, 0, axis_z - r), vec(0, 0, -1), 0.084, 0.25);
    item_nozzle(&item, "N3", vec(half - 0.5, 0, axis_z + r), vec(0, 0, 1), 0.084, 0.25);
    item_manway(&item, vec(0.1, 0, axis_z + r), vec(0, 0, 1), 0.26, 0.22);
    struct profile boot = { 0 };
    profile_bowl(&boot, 0.30, -0.72, 0.15, 6);
    profile_edge(&boot, 0.30, 0.1);
    shape_revolve(shell, frame_at(-half + 0.95, 0, axis_z - r), &boot, 28, 0.1);
    item_nozzle(&item, "N4", vec(-half + 0.95, 0, axis_z - r - 0.87), vec(0, 0, -1), 0.03, 0.12);
    double chord = r * cos(RADIANS(35.0));
    level_gauge(&item, vec(0.9, -chord, axis_z - r * 0.57), vec(0.9, -chord, axis_z + r * 0.57), vec(0, -1, 0));
    for (int i = -1; i <= 1; i += 2)
        saddle_build(item.necks, i * length * 0.30, axis_z, base_z, r);
    item_end(&item);
}

void knockout_build(struct site *site, const char *name, struct frame at, double r, double length)
{
    const double skirt = 1.5, top = skirt + length;
    struct item item = item_begin(&site->model, name, at);
    item.necks = item_part(&item, "nozzles", MATERIAL_VESSEL);
    item.flanges = item_part(&item, "flanges", MATERIAL_BOLTING);
    struct profile profile = { 0 };
    profile_bowl(&profile, r, skirt, r * 0.5, 10);
    profile_edge(&profile, r, (skirt + top) / 2 - 0.012);
    profile_smooth(&profile, r + 0.004, (skirt + top) / 2);
    profile_edge(&profile, r, (skirt + top) / 2 + 0.012);
    profile_dome(&profile, r, top, r * 0.5, 10);
    shape_revolve(item_part(&item, "shell", MATERIAL_VESSEL), frame_at(0, 0, 0), &profile, 48, 0.12);
    struct profile cone = { 0 };
    profile_edge(&cone, r + 0.14, 0.20);
    profile_edge(&cone, r + 0.14, 0.23);
    profile_edge(&cone, r + 0.015, 0.23);
    profile_edge(&cone, r - 0.015, skirt + 0.12);
    shape_revolve(item_part(&item, "skirt", MATERIAL_STRUCTURE), frame_at(0, 0, 0), &cone, 48, 0.2);
    for (int i = 0; i < 8; i++)
        shape_hexagon(item.flanges, frame_moved(frame_turned(frame_at(0, 0, 0), 45.0 * i), r + 0.09, 0, 0), 0.024, 0.22, 0.31);
    civil_plinth(site, at, -r - 0.3, r + 0.3, -r - 0.3, r + 0.3, 0.20);
    item_nozzle(&item, "N1", vec(-r, 0, skirt + 0.9), vec(-1, 0, 0), 0.084, 0.25);
    item_nozzle(&item, "N2", vec(0, 0, top + r * 0.5), vec(0, 0, 1), 0.084, 0.22);
    item_connect(&item, "N3", frame_facing(vec(0, 0, skirt - r * 0.5), vec(0, 0, -1), vec(1, 0, 0)), 0.03);
    item_manway(&item, vec(0, -r, skirt + 0.75), vec(0, -1, 0), 0.25, 0.22);
    level_gauge(&item, vec_polar(r, -35, skirt + 1.2), vec_polar(r, -35, skirt + 2.3), vec_polar(1, -35, 0));
    struct item access = item_begin_group(&site->access, name, at);
    struct mesh *steel = item_part(&access, "platform", MATERIAL_GALVANISED);
    struct mesh *rail = item_part(&access, "handrails", MATERIAL_SAFETY_YELLOW);
    steel_ring_platform(steel, rail, frame_at(0, 0, top - 0.1), r + 0.03, r + 0.95, 180, 330);
    struct vec foot = vec_polar(r + 1.08, 225, 0);
    steel_ladder(steel, frame_facing(foot, vec(0, 0, 1), vec_polar(1, 135, 0)), top - 0.1);
    item_end(&access);
    item_end(&item);
}
