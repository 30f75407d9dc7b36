/* SPDX-License-Identifier: GPL-3.0-or-later */
/* End-suction process pumps: volute, bearing frame, coupling guard, motor, baseplate. */
#include "equipment.h"
#include "fitting.h"
#include "machine.h"
#include "shape.h"

#define PLINTH_M 0.25
#define SHAFT_M 0.82

static void pump_casing(struct item *item)
{
    struct mesh *casing = item_part(item, "casing", MATERIAL_PUMP);
    struct frame suction = frame_facing(vec(-0.32, 0, SHAFT_M), vec(-1, 0, 0), vec(0, 0, 1));
    struct profile profile = { 0 };
    profile_edge(&profile, 0.09, -0.15);
    profile_edge(&profile, 0.26, -0.15);
    profile_edge(&profile, 0.265, -0.095);
    profile_edge(&profile, 0.235, -0.09);
    profile_smooth(&profile, 0.255, -0.04);
    profile_smooth(&profile, 0.275, 0.02);
    profile_smooth(&profile, 0.26, 0.08);
    profile_smooth(&profile, 0.20, 0.13);
    profile_smooth(&profile, 0.13, 0.16);
    profile_smooth(&profile, 0.095, 0.21);
    profile_edge(&profile, 0.084, 0.34);
    shape_revolve(casing, suction, &profile, 40, 0.035);
    struct frame up = frame_at(-0.32, 0, SHAFT_M);
    shape_tube(casing, frame_moved(up, 0, 0, 0.15), 0.105, 0.070, 0.26, 28, 0.035);
    for (int i = 0; i < 12; i++) /* casing bolts */
        shape_hexagon(item->flanges, frame_moved(frame_turned(suction, 30.0 * i + 15.0), 0.248, 0, 0), 0.013, -0.175, -0.075);
    for (int i = -1; i <= 1; i += 2)
        shape_block(casing, frame_at(-0.32, i * 0.22, 0), -0.07, 0.07, -0.05, 0.05, 0.40, SHAFT_M - 0.1);
}

static void pump_bearings(struct item *item)
{
    struct mesh *frame = item_part(item, "bearing housing", MATERIAL_PUMP);
    struct profile profile = { 0 };
    profile_edge(&profile, 0.075, -0.10);
    profile_edge(&profile, 0.11, -0.02);
    profile_edge(&profile, 0.135, 0.0);
    profile_edge(&profile, 0.135, 0.045);
    profile_smooth(&profile, 0.11, 0.06);
    profile_smooth(&profile, 0.11, 0.26);
    profile_edge(&profile, 0.13, 0.275);
    profile_edge(&profile, 0.13, 0.32);
    profile_edge(&profile, 0.055, 0.335);
    profile_edge(&profile, 0.0, 0.335);
    shape_revolve(frame, frame_facing(vec(-0.10, 0, SHAFT_M), vec(1, 0, 0), vec(0, 0, 1)), &profile, 32, 0.035);
    shape_block(frame, frame_at(0.05, 0, 0), -0.09, 0.09, -0.07, 0.07, 0.40, SHAFT_M - 0.08);
    shape_cylinder(frame, frame_at(0.05, 0, SHAFT_M + 0.10), 0.018, 0.06, 10, 0);                               /* oil filler */
    shape_cylinder(item_part(item, "oiler", MATERIAL_STAINLESS), frame_at(0.05, -0.12, SHAFT_M - 0.06), 0.028, 0.09, 12, 0);
}

void pump_plinth(struct site *site, struct frame at)
{
    civil_plinth(site, at, -0.80, 1.62, -0.46, 0.46, PLINTH_M);
}

void pump_build(struct site *site, const char *name, struct frame at)
{
    struct item item = item_begin(&site->model, name, at);
    item.necks = item_part(&item, "casing", MATERIAL_PUMP);
    item.flanges = item_part(&item, "flanges", MATERIAL_BOLTING);
    struct mesh *base = item_part(&item, "baseplate", MATERIAL_STRUCTURE);
    shape_block(base, frame_at(0, 0, 0), -0.68, 1.50, -0.36, 0.36, PLINTH_M - 0.01, 0.38);
    shape_block(base, frame_at(0, 0, 0), -0.71, 1.53, -0.39, 0.39, 0.38, 0.40);
    pump_casing(&item);
    pump_bearings(&item);
    machine_guard(&item, frame_facing(vec(0.245, 0, SHAFT_M), vec(1, 0, 0), vec(0, 0, 1)), 0.13, 0.30, SHAFT_M - 0.39);
    machine_motor(&item, frame_facing(vec(0.57, 0, SHAFT_M), vec(1, 0, 0), vec(0, 0, 1)), 0.235, 0.86, SHAFT_M - 0.40);
    struct frame suction = frame_facing(vec(-0.70, 0, SHAFT_M), vec(-1, 0, 0), vec(0, 0, 1));
    struct frame discharge = frame_facing(vec(-0.32, 0, SHAFT_M + 0.46), vec(0, 0, 1), vec(1, 0, 0));
    fitting_flange(item.flanges, suction, 0.084);
    fitting_flange(item.flanges, discharge, 0.070);
    item_connect(&item, "N1", suction, 0.084);
    item_connect(&item, "N2", discharge, 0.070);
    pump_plinth(site, at);
    item_end(&item);
}
