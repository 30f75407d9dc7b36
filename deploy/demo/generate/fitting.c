/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Flanges, nozzles, valves and supports, proportioned after the common standards. */
#include "fitting.h"

#include "shape.h"

static int round_sides(double r)
{
    return r < 0.05 ? 12 : r < 0.12 ? 18 : r < 0.3 ? 24 : 32;
}

double fitting_flange_radius(double r)
{
    return 1.32 * r + 0.038;
}

double fitting_flange_thickness(double r)
{
    return 0.016 + 0.085 * r;
}

void fitting_flange(struct mesh *mesh, struct frame at, double r)
{
    double outer = fitting_flange_radius(r), thick = fitting_flange_thickness(r);
    struct profile profile = { 0 };
    profile_edge(&profile, r - 0.001, -thick * 2.6);
    profile_edge(&profile, r * 1.22, -thick);
    profile_edge(&profile, outer, -thick);
    profile_edge(&profile, outer, -0.002);
    profile_edge(&profile, r * 1.2, -0.002);
    profile_edge(&profile, r * 0.9, -0.002);
    shape_revolve(mesh, at, &profile, round_sides(r), 0);
}

static int stud_count(double r)
{
    return r < 0.04 ? 4 : r < 0.13 ? 8 : r < 0.2 ? 12 : r < 0.3 ? 16 : 20;
}

void fitting_studs(struct mesh *mesh, struct frame at, double r)
{
    int count = stud_count(r);
    double size = 0.010 + 0.035 * r, circle = fitting_flange_radius(r) - 1.35 * size - 0.004;
    double half = fitting_flange_thickness(r) + size * 1.1;
    for (int i = 0; i < count; i++) {
        struct frame stud = frame_turned(at, 360.0 * (i + 0.5) / count);
        shape_hexagon(mesh, frame_moved(stud, circle, 0, 0), size, -half, half);
    }
}

/* A flanged blind end (manway, spare nozzle): face at the origin, cover in front of it. */
static void add_blind(struct mesh *mesh, struct frame at, double r)
{
    double outer = fitting_flange_radius(r), thick = fitting_flange_thickness(r);
    struct profile profile = { 0 };
    profile_edge(&profile, outer, 0.002);
    profile_edge(&profile, outer, thick * 0.9);
    profile_edge(&profile, outer - 0.006, thick);
    profile_edge(&profile, 0, thick);
    shape_revolve(mesh, at, &profile, round_sides(r), 0);
    fitting_flange(mesh, at, r);
    fitting_studs(mesh, at, r);
}

static struct frame nozzle_neck(struct item *item, struct vec surface, struct vec dir, double r, double length)
{
    struct frame base = frame_facing(surface, dir, vec(0, 0, 1)), face = frame_moved(base, 0, 0, length);
    double inside = 0.35 * r + 0.03;
    double hub = length - fitting_flange_thickness(r) * 2.59;
    shape_tube(item->necks, frame_moved(base, 0, 0, -inside), r, r, hub + inside, round_sides(r), 0);
    struct profile pad = { 0 }; /* reinforcing pad, half sunk into the shell */
    profile_edge(&pad, r * 1.5 + 0.02, -inside);
    profile_edge(&pad, r * 1.5 + 0.02, 0.004);
    profile_edge(&pad, r, 0.012);
    shape_revolve(item->necks, base, &pad, round_sides(r), 0);
    return face;
}

struct frame item_nozzle(struct item *item, const char *name, struct vec surface, struct vec dir, double r, double length)
{
    struct frame face = nozzle_neck(item, surface, dir, r, length);
    fitting_flange(item->flanges, face, r);
    item_connect(item, name, face, r);
    return face;
}

void item_manway(struct item *item, struct vec surface, struct vec dir, double r, double length)
{
    struct frame face = nozzle_neck(item, surface, dir, r, length);
    add_blind(item->flanges, face, r);
    double thick = fitting_flange_thickness(r);
    struct vec side = face.y; /* the handle and the davit on which the cover swings */
    struct vec grip = frame_point(&face, vec(0, 0, thick));
    shape_torus(item->flanges, frame_facing(grip, side, face.x), 0.07, 0.011, 0, 180, 6, 6);
    struct vec foot = vec_along(face.o, side, fitting_flange_radius(r) + 0.012);
    shape_bar(item->necks, vec_along(foot, face.z, -length * 0.8), vec_along(foot, face.z, thick), 0.02, 8);
}

double fitting_valve_length(double r)
{
    return 3.0 * r + 0.12;
}

static void valve_body(struct item *item, struct frame at, double r)
{
    struct mesh *body = item_part(item, "valves", MATERIAL_PIPE), *bolts = item_part(item, "bolts", MATERIAL_BOLTING);
    double half = fitting_valve_length(r) / 2.0;
    struct profile profile = { 0 };
    profile_smooth(&profile, r, -half);
    profile_smooth(&profile, r * 1.02, -half * 0.55);
    profile_smooth(&profile, r * 1.38, -half * 0.2);
    profile_smooth(&profile, r * 1.38, half * 0.2);
    profile_smooth(&profile, r * 1.02, half * 0.55);
    profile_smooth(&profile, r, half);
    shape_revolve(body, at, &profile, round_sides(r), 0);
    for (int end = -1; end <= 1; end += 2) {
        struct frame face = frame_facing(frame_point(&at, vec(0, 0, half * end)), vec_scale(at.z, end), at.x);
        fitting_flange(body, face, r);
        fitting_studs(bolts, face, r);
    }
}

static void valve_bonnet(struct item *item, struct frame up, double r, double height)
{
    struct mesh *body = item_part(item, "valves", MATERIAL_PIPE);
    struct profile profile = { 0 };
    profile_edge(&profile, r * 0.9, 0);
    profile_edge(&profile, r * 0.8, r * 1.5);
    profile_edge(&profile, r * 1.25, r * 1.5);
    profile_edge(&profile, r * 1.25, r * 1.5 + 0.04);
    profile_edge(&profile, r * 0.6, r * 1.5 + 0.05);
    profile_edge(&profile, r * 0.35, height);
    profile_edge(&profile, 0, height);
    shape_revolve(body, up, &profile, 14, 0);
}

void fitting_gate_valve(struct item *item, struct frame at, double r)
{
    valve_body(item, at, r);
    struct frame up = frame_facing(at.o, at.x, at.z);
    double height = 3.2 * r + 0.12, stem = height + 1.2 * r + 0.08, wheel = 1.15 * r + 0.06;
    valve_bonnet(item, up, r, height);
    shape_cylinder(item_part(item, "bolts", MATERIAL_BOLTING), up, 0.010 + 0.06 * r, stem + 0.06, 8, 0);
    struct mesh *red = item_part(item, "handwheels", MATERIAL_HANDWHEEL);
    struct frame rim = frame_moved(up, 0, 0, stem);
    shape_torus(red, rim, wheel, 0.009 + 0.03 * r, 0, 360, 20, 6);
    for (int i = 0; i < 3; i++)
        shape_bar(red, rim.o, frame_point(&rim, vec_polar(wheel, 120.0 * i + 30.0, 0)), 0.008 + 0.015 * r, 6);
}

void fitting_control_valve(struct item *item, struct frame at, double r)
{
    valve_body(item, at, r);
    struct frame up = frame_facing(at.o, at.x, at.z);
    double yoke = 2.6 * r + 0.10, top = yoke + 0.34, wide = 0.13 + 0.6 * r;
    valve_bonnet(item, up, r, yoke);
    struct mesh *steel = item_part(item, "bolts", MATERIAL_BOLTING), *actuator = item_part(item, "actuators", MATERIAL_ACTUATOR);
    for (int side = -1; side <= 1; side += 2)
        shape_bar(steel, frame_point(&up, vec(0, side * 0.06, yoke - 0.05)), frame_point(&up, vec(0, side * 0.06, top + 0.02)), 0.014, 6);
    shape_cylinder(steel, up, 0.012, top + 0.05, 8, 0);
    struct profile head = { 0 }; /* spring-and-diaphragm: two dished halves with a flanged rim */
    profile_edge(&head, 0.011, top - 0.02);
    profile_edge(&head, wide * 0.75, top + 0.01);
    profile_smooth(&head, wide * 0.95, top + 0.05);
    profile_edge(&head, wide * 1.1, top + 0.065);
    profile_edge(&head, wide * 1.1, top + 0.085);
    profile_smooth(&head, wide * 0.95, top + 0.10);
    profile_smooth(&head, wide * 0.7, top + 0.16);
    profile_smooth(&head, wide * 0.25, top + 0.185);
    profile_smooth(&head, 0, top + 0.19);
    shape_revolve(actuator, up, &head, 22, 0);
    shape_block(item_part(item, "positioners", MATERIAL_BLACK), up, 0.0, 0.13, -0.06, 0.06, yoke + 0.08, yoke + 0.22);
}

void fitting_post(struct item *access, struct item *civil, struct vec under, double r)
{
    struct mesh *steel = item_part(access, "supports", MATERIAL_STRUCTURE), *plinth = item_part(civil, "plinths", MATERIAL_PLINTH);
    struct frame at = frame_at(under.x, under.y, 0);
    double wide = fmax(0.06, r * 0.8);
    shape_block(plinth, at, -wide - 0.09, wide + 0.09, -wide - 0.09, wide + 0.09, -0.05, 0.12);
    shape_block(steel, at, -wide - 0.04, wide + 0.04, -wide - 0.04, wide + 0.04, 0.12, 0.135);
    shape_cylinder(steel, frame_moved(at, 0, 0, 0.13), wide * 0.6, under.z - 0.14, 10, 0);
    shape_block(steel, at, -wide - 0.03, wide + 0.03, -wide - 0.03, wide + 0.03, under.z - 0.02, under.z + 0.004);
}

void fitting_pipe_shoe(struct item *access, struct vec under, struct vec along, double height)
{
    struct frame at = frame_facing(under, vec(0, 0, 1), along);
    struct mesh *steel = item_part(access, "supports", MATERIAL_STRUCTURE);
    shape_block(steel, at, -0.15, 0.15, -0.006, 0.006, -height, 0.01);
    shape_block(steel, at, -0.15, 0.15, -0.06, 0.06, -height, -height + 0.01);
}
