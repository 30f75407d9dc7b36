/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The off-gas compressor: barrel casing, gear, motor with cooler, lube oil console, all on one skid. */
#include "equipment.h"
#include "fitting.h"
#include "machine.h"
#include "shape.h"

#define SHAFT_M 1.45
#define DECK_M 0.62

static struct frame along_shaft(double x)
{
    return frame_facing(vec(x, 0, SHAFT_M), vec(1, 0, 0), vec(0, 0, 1));
}

static void compressor_casing(struct item *item)
{
    struct mesh *casing = item_part(item, "casing", MATERIAL_PUMP);
    struct profile profile = { 0 };
    profile_edge(&profile, 0.0, -0.30);
    profile_edge(&profile, 0.16, -0.30);
    profile_edge(&profile, 0.20, -0.27);
    profile_edge(&profile, 0.20, -0.06);
    profile_edge(&profile, 0.34, -0.02);
    profile_edge(&profile, 0.62, 0.0);
    profile_edge(&profile, 0.62, 0.13);
    profile_smooth(&profile, 0.54, 0.17);
    profile_smooth(&profile, 0.54, 1.03);
    profile_edge(&profile, 0.62, 1.07);
    profile_edge(&profile, 0.62, 1.20);
    profile_edge(&profile, 0.34, 1.22);
    profile_edge(&profile, 0.20, 1.26);
    profile_edge(&profile, 0.20, 1.47);
    profile_edge(&profile, 0.08, 1.50);
    shape_revolve(casing, along_shaft(-2.0), &profile, 52, 0.07);
    for (int end = 0; end < 2; end++)
        for (int i = 0; i < 20; i++) {
            struct frame at = frame_turned(along_shaft(-2.0 + 0.065 + end * 1.07), 18.0 * i + 9.0);
            shape_hexagon(item->flanges, frame_moved(at, 0.575, 0, 0), 0.022, -0.095, 0.095);
        }
    for (int i = -1; i <= 1; i += 2)
        for (int k = -1; k <= 1; k += 2)
            shape_block(casing, frame_at(-1.4 + k * 0.36, i * 0.42, 0), -0.11, 0.11, -0.09, 0.09, DECK_M - 0.01, SHAFT_M - 0.30);
}

static void compressor_gear(struct item *item)
{
    struct mesh *gear = item_part(item, "gear", MATERIAL_PUMP);
    struct frame at = frame_at(0.28, 0, 0);
    shape_block(gear, at, -0.34, 0.34, -0.48, 0.48, DECK_M, SHAFT_M - 0.03);
    shape_block(gear, at, -0.38, 0.38, -0.52, 0.52, SHAFT_M - 0.03, SHAFT_M + 0.03);
    shape_block(gear, at, -0.34, 0.34, -0.46, 0.46, SHAFT_M + 0.03, SHAFT_M + 0.26);
    shape_block(gear, at, -0.26, 0.26, -0.36, 0.36, SHAFT_M + 0.26, SHAFT_M + 0.34);
    for (int i = 0; i < 10; i++)
        shape_hexagon(item->flanges, frame_at(-0.02 + 0.60 * (i % 2), -0.4 + 0.2 * (i / 2.0 - (i % 2) / 2.0), 0), 0.02, SHAFT_M - 0.06,
                      SHAFT_M + 0.06);
    for (int i = -1; i <= 1; i += 2)
        shape_cylinder(gear, frame_facing(vec(0.28 + i * 0.30, 0, SHAFT_M), vec(i, 0, 0), vec(0, 0, 1)), 0.15, 0.12, 24, 0);
}

static void compressor_auxiliaries(struct item *item)
{
    struct mesh *console = item_part(item, "oil console", MATERIAL_VESSEL), *steel = item_part(item, "oil pipes", MATERIAL_STAINLESS);
    struct frame at = frame_at(0.2, -1.25, 0);
    shape_block(console, at, -0.9, 0.9, -0.35, 0.35, 0.30, 0.95);
    for (int i = -1; i <= 1; i += 2) {
        struct profile filter = { 0 };
        profile_edge(&filter, 0.10, 0.94);
        profile_smooth(&filter, 0.10, 1.40);
        profile_dome(&filter, 0.10, 1.40, 0.06, 4);
        shape_revolve(console, frame_moved(at, 0.5 + i * 0.15, 0.1, 0), &filter, 18, 0);
    }
    shape_cylinder(steel, frame_facing(vec(-0.5, -1.25, 1.06), vec(1, 0, 0), vec(0, 0, 1)), 0.12, 0.7, 20, 0); /* oil cooler */
    for (int i = 0; i < 4; i++) {
        double x = -1.75 + 0.95 * i;
        shape_bar(steel, vec(x, -0.80, 0.75), vec(x, -0.80, SHAFT_M - 0.05), 0.02, 8);
        shape_bar(steel, vec(x, -0.82, SHAFT_M - 0.05), vec(x, -0.1, SHAFT_M - 0.05), 0.02, 8);
    }
    shape_bar(steel, vec(-1.8, -0.80, 0.75), vec(1.15, -0.80, 0.75), 0.03, 10);
    struct mesh *panel = item_part(item, "local panel", MATERIAL_VESSEL);
    shape_block(panel, frame_at(-2.35, -1.15, 0), -0.1, 0.1, -0.4, 0.4, 0.3, 1.75);
    struct mesh *gauges = item_part(item, "gauges", MATERIAL_BLACK);
    for (int i = 0; i < 6; i++) { /* facing west */
        struct vec middle = vec(-2.44, -1.4 + 0.25 * (i % 3), 1.35 + 0.22 * (i / 3));
        shape_cylinder(gauges, frame_facing(middle, vec(-1, 0, 0), vec(0, 0, 1)), 0.075, 0.03, 18, 0);
    }
}

void compressor_build(struct site *site, const char *name, struct frame at)
{
    struct item item = item_begin(&site->model, name, at);
    struct mesh *skid = item_part(&item, "skid", MATERIAL_STRUCTURE);
    item.necks = item_part(&item, "casing", MATERIAL_PUMP);
    item.flanges = item_part(&item, "flanges", MATERIAL_BOLTING);
    civil_plinth(site, at, -2.7, 2.7, -1.8, 1.1, 0.30);
    shape_block(skid, frame_at(0, 0, 0), -2.5, 2.5, -0.85, 0.85, 0.29, 0.58);
    shape_block(skid, frame_at(0, 0, 0), -2.55, 2.55, -0.90, 0.90, 0.58, DECK_M);
    compressor_casing(&item);
    compressor_gear(&item);
    compressor_auxiliaries(&item);
    machine_guard(&item, along_shaft(-0.52), 0.17, 0.46, SHAFT_M - DECK_M + 0.01);
    machine_guard(&item, along_shaft(0.70), 0.17, 0.32, SHAFT_M - DECK_M + 0.01);
    machine_motor(&item, along_shaft(1.04), 0.56, 1.40, SHAFT_M - DECK_M);
    struct mesh *motor = item_part(&item, "motor", MATERIAL_MOTOR);
    shape_block(motor, frame_at(1.62, 0, 0), -0.36, 0.36, -0.42, 0.42, SHAFT_M + 0.48, SHAFT_M + 0.86); /* air-to-air cooler */
    shape_block(motor, frame_at(1.62, 0, 0), -0.40, 0.40, -0.46, 0.46, SHAFT_M + 0.86, SHAFT_M + 0.90);
    item_nozzle(&item, "N1", vec(-1.68, 0, SHAFT_M + 0.54), vec(0, 0, 1), 0.084, 0.30);
    item_nozzle(&item, "N2", vec(-1.10, 0, SHAFT_M + 0.54), vec(0, 0, 1), 0.070, 0.30);
    item_end(&item);
}
