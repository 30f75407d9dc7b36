/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The air-cooled condenser: finned tubes between header boxes, plenums, fan rings, fans, motors, header walkways. */
#include "equipment.h"
#include "fitting.h"
#include "machine.h"
#include "shape.h"
#include "steel.h"

#define LEG_Y 2.5 /* the legs stand on the rack's edge beams */
#define FAN_Z 1.25
#define PLENUM_Z 1.60
#define BUNDLE_Z 2.25

static void bundle(struct item *item, double x, double width, double length)
{
    struct mesh *tubes = item_part(item, "tubes", MATERIAL_CLADDING), *frame = item_part(item, "side frames", MATERIAL_GALVANISED);
    struct mesh *headers = item_part(item, "headers", MATERIAL_VESSEL);
    const int count = 20;
    double half = width / 2 - 0.12, y = length / 2;
    for (int i = 0; i < count; i++) {
        struct frame at = frame_facing(vec(x - half + 0.08 + (2 * half - 0.16) * i / (count - 1), -y + 0.3, BUNDLE_Z + 0.34),
                                       vec(0, 1, 0), vec(0, 0, 1));
        shape_tube(tubes, at, 0.068, 0.068, length - 0.6, 8, 0.5);
    }
    shape_block(tubes, frame_at(x, 0, 0), -half + 0.02, half - 0.02, -y + 0.3, y - 0.3, BUNDLE_Z + 0.02, BUNDLE_Z + 0.28);
    for (int side = -1; side <= 1; side += 2) {
        shape_block(frame, frame_at(x + side * half, 0, 0), -0.02, 0.02, -y, y, BUNDLE_Z - 0.05, BUNDLE_Z + 0.48);
        shape_block(headers, frame_at(x, side * (y - 0.16), 0), -half + 0.05, half - 0.05, -0.14, 0.14, BUNDLE_Z + 0.0, BUNDLE_Z + 0.46);
        for (int i = 0; i < 14; i++) /* plugs opposite the tubes */
            for (int row = 0; row < 2; row++) {
                struct vec p = vec(x - half + 0.22 + (2 * half - 0.44) * i / 13, side * (y - 0.03), BUNDLE_Z + 0.14 + 0.18 * row);
                shape_hexagon(item->flanges, frame_facing(p, vec(0, side, 0), vec(0, 0, 1)), 0.035, 0, 0.03);
            }
    }
}

static void fan(struct item *item, double x, double y, double r)
{
    struct mesh *ring = item_part(item, "fan rings", MATERIAL_GALVANISED), *blades = item_part(item, "fans", MATERIAL_INSTRUMENT);
    struct profile bell = { 0 };
    profile_edge(&bell, r + 0.10, FAN_Z - 0.22);
    profile_smooth(&bell, r + 0.02, FAN_Z - 0.12);
    profile_edge(&bell, r + 0.01, PLENUM_Z);
    shape_revolve(ring, frame_at(x, y, 0), &bell, 32, 0);
    shape_sector(ring, frame_at(x, y, 0), r - 0.01, r + 0.01, FAN_Z - 0.2, PLENUM_Z, 0, 360, 32);
    for (int i = 0; i < 6; i++) {
        struct frame hub = frame_turned(frame_at(x, y, FAN_Z), 60.0 * i + 11.0);
        struct frame blade = frame_facing(hub.o, hub.x, vec_add(vec_scale(hub.z, 0.86), vec_scale(hub.y, 0.5)));
        shape_block(blades, blade, -0.012, 0.012, -0.13, 0.13, 0.14, r - 0.03);
    }
    shape_cylinder(blades, frame_at(x, y, FAN_Z - 0.08), 0.17, 0.16, 20, 0);
    machine_motor(item, frame_facing(vec(x, y, FAN_Z - 0.20), vec(0, 0, -1), vec(0, 1, 0)), 0.16, 0.55, 0.30);
    shape_block(item_part(item, "side frames", MATERIAL_GALVANISED), frame_at(x, y, 0), -r, r, -0.36, -0.28, FAN_Z - 0.62, FAN_Z - 0.48);
    shape_cylinder(blades, frame_at(x, y, FAN_Z - 0.24), 0.04, 0.2, 10, 0);
    for (int side = -1; side <= 1; side += 2) /* hangers of the motor beam */
        shape_block(ring, frame_at(x + side * (r - 0.04), y - 0.32, 0), -0.06, 0.06, -0.05, 0.05, FAN_Z - 0.62, PLENUM_Z);
}

static void bay(struct item *item, struct item *access, double x, double width, double length)
{
    struct mesh *plenum = item_part(item, "plenums", MATERIAL_GALVANISED), *legs = item_part(access, "legs", MATERIAL_STRUCTURE);
    double half = width / 2 - 0.1, y = length / 2 - 0.15;
    bundle(item, x, width, length);
    struct frame at = frame_at(x, 0, 0);
    shape_block(plenum, at, -half, half, -y, -y + 0.02, PLENUM_Z, BUNDLE_Z);
    shape_block(plenum, at, -half, half, y - 0.02, y, PLENUM_Z, BUNDLE_Z);
    shape_block(plenum, at, -half, -half + 0.02, -y, y, PLENUM_Z, BUNDLE_Z);
    shape_block(plenum, at, half - 0.02, half, -y, y, PLENUM_Z, BUNDLE_Z);
    shape_block(plenum, at, -half, half, -y, y, PLENUM_Z - 0.02, PLENUM_Z);
    for (int i = -3; i <= 3; i++) /* stiffeners on the side sheets */
        for (int side = -1; side <= 1; side += 2)
            shape_block(plenum, frame_at(x + side * half, i * y / 3.2, 0), -0.04, 0.04, -0.02, 0.02, PLENUM_Z, BUNDLE_Z);
    for (int i = -1; i <= 1; i += 2) {
        fan(item, x, i * length * 0.25, width * 0.36);
        for (int side = -1; side <= 1; side += 2) {
            double leg_x = x + side * half, leg_y = i * LEG_Y;
            steel_beam(legs, vec(leg_x, leg_y, 0), vec(leg_x, leg_y, BUNDLE_Z), vec(1, 0, 0), 0.16, 0.16);
        }
    }
}

void air_cooler_build(struct site *site, const char *name, struct frame at, double bay_width, double tube_length)
{
    struct item item = item_begin(&site->model, name, at);
    struct item access = item_begin_group(&site->access, name, at);
    struct mesh *steel = item_part(&access, "walkways", MATERIAL_GALVANISED);
    struct mesh *rail = item_part(&access, "handrails", MATERIAL_SAFETY_YELLOW);
    item.necks = item_part(&item, "nozzles", MATERIAL_VESSEL);
    item.flanges = item_part(&item, "flanges", MATERIAL_BOLTING);
    double y = tube_length / 2;
    for (int i = 0; i < 2; i++) {
        double x = (i ? 0.5 : -0.5) * bay_width;
        const char *inlets[] = { "N1", "N2" }, *outlets[] = { "N3", "N4" };
        bay(&item, &access, x, bay_width, tube_length);
        item_nozzle(&item, inlets[i], vec(x, -y + 0.16, BUNDLE_Z + 0.46), vec(0, 0, 1), 0.110, 0.2);
        item_nozzle(&item, outlets[i], vec(x, y - 0.16, BUNDLE_Z), vec(0, 0, -1), 0.084, 0.2);
    }
    for (int side = -1; side <= 1; side += 2) {
        double inner = side * (y + 0.05), outer = side * (y + 0.95);
        steel_floor(steel, frame_at(0, 0, 0), -bay_width, bay_width, fmin(inner, outer), fmax(inner, outer), BUNDLE_Z - 0.35);
        struct vec points[] = { vec(-bay_width, inner, BUNDLE_Z - 0.35), vec(-bay_width, outer, BUNDLE_Z - 0.35),
                                vec(bay_width, outer, BUNDLE_Z - 0.35),
                                vec(bay_width, inner, BUNDLE_Z - 0.35) };
        steel_handrail(rail, points, 4);
        for (int i = -2; i <= 2; i++)
            shape_bar(steel, vec(i * bay_width / 2, outer - side * 0.1, BUNDLE_Z - 0.39), vec(i * bay_width / 2, side * (y - 0.25), 0.8),
                      0.04, 6);
    }
    item_end(&access);
    item_end(&item);
}
