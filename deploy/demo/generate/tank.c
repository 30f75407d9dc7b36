/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cone-roof storage tanks with spiral stairs and roof handrails. */
#include "equipment.h"
#include "fitting.h"
#include "shape.h"
#include "steel.h"

#define BASE_M 0.35

static void tank_shell(struct item *item, const struct tank_spec *spec)
{
    struct mesh *shell = item_part(item, "shell", MATERIAL_TANK);
    struct frame base = frame_at(0, 0, BASE_M);
    struct profile profile = { 0 };
    profile_edge(&profile, spec->r + 0.08, 0.0);
    profile_edge(&profile, spec->r + 0.08, 0.012);
    profile_edge(&profile, spec->r, 0.012);
    for (int i = 1; i <= 4; i++) { /* plate courses, thinner towards the top, with weld seams */
        double z = spec->height * i / 5;
        profile_edge(&profile, spec->r - 0.003 * (i - 1), z - 0.02);
        profile_smooth(&profile, spec->r + 0.006 - 0.003 * (i - 1), z);
        profile_edge(&profile, spec->r - 0.003 * i, z + 0.02);
    }
    profile_edge(&profile, spec->r - 0.012, spec->height - 0.1);
    profile_edge(&profile, spec->r + 0.06, spec->height - 0.1);
    profile_edge(&profile, spec->r + 0.06, spec->height - 0.085);
    profile_edge(&profile, spec->r, spec->height - 0.08);
    profile_edge(&profile, spec->r, spec->height);
    profile_edge(&profile, 0, spec->height + spec->r * 0.18);
    shape_revolve(shell, base, &profile, 64, 0.36);
}

static void tank_stair(struct item *item, const struct tank_spec *spec)
{
    struct mesh *steel = item_part(item, "stairs", MATERIAL_GALVANISED), *rail = item_part(item, "handrails", MATERIAL_SAFETY_YELLOW);
    const double r0 = spec->r + 0.10, r1 = spec->r + 0.85, going_deg = 0.25 / (spec->r + 0.5) * 180.0 / M_PI;
    const int treads = (int)round((spec->height + 0.12) / 0.2);
    struct vec outer[16];
    int count = 0;
    for (int i = 1; i <= treads; i++) {
        double deg = spec->stair_from_deg + going_deg * i, z = BASE_M + (spec->height + 0.12) * i / treads;
        shape_sector(steel, frame_at(0, 0, z), r0, r1, -0.03, 0, deg - going_deg * 0.55, deg + going_deg * 0.55, 2);
        for (int side = 0; side < 2; side++) {
            double r = side ? r1 : r0;
            struct vec a = vec_polar(r, deg - going_deg / 2, z - 0.15), b = vec_polar(r, deg + going_deg / 2, z + 0.05);
            shape_block(steel, frame_facing(a, vec_sub(b, a), vec(0, 0, 1)), -0.10, 0.10, -0.006, 0.006, 0, vec_length(vec_sub(b, a)));
        }
        if ((i % 3 == 1 || i == treads) && count < 16)
            outer[count++] = vec_polar(r1, deg, z);
        if (i % 5 == 0)
            shape_bar(steel, vec_polar(r1 - 0.05, deg, z - 0.05), vec_polar(spec->r - 0.02, deg, z - 0.65), 0.03, 6);
    }
    steel_handrail(rail, outer, count);
    double end = spec->stair_from_deg + going_deg * (treads + 0.5), top = BASE_M + spec->height + 0.12;
    steel_ring_platform(steel, rail, frame_at(0, 0, top), spec->r - 0.5, r1, end, end + 30.0);
}

static void tank_roof(struct item *item, struct item *access, const struct tank_spec *spec)
{
    struct mesh *rail = item_part(access, "handrails", MATERIAL_SAFETY_YELLOW), *fittings = item_part(item, "roof fittings", MATERIAL_TANK);
    const double going_deg = 0.25 / (spec->r + 0.5) * 180.0 / M_PI, treads = round((spec->height + 0.12) / 0.2);
    double landing = spec->stair_from_deg + going_deg * (treads + 0.5) + 30.0;
    struct vec points[20];
    for (int i = 0; i < 20; i++)
        points[i] = vec_polar(spec->r - 0.05, landing + 330.0 * i / 19, BASE_M + spec->height + 0.01);
    steel_handrail(rail, points, 20);
    double peak = BASE_M + spec->height + spec->r * 0.18;
    shape_cylinder(fittings, frame_at(0, 0, peak - 0.1), 0.11, 0.58, 18, 0);
    struct profile cap = { 0 };
    profile_edge(&cap, 0.20, peak + 0.32);
    profile_edge(&cap, 0.22, peak + 0.40);
    profile_edge(&cap, 0.0, peak + 0.52);
    shape_revolve(fittings, frame_at(0, 0, 0), &cap, 18, 0);
    for (int i = 0; i < 2; i++) {
        struct vec p = vec_polar(spec->r * 0.62, landing + 60.0 + 110.0 * i, BASE_M + spec->height + spec->r * 0.18 * 0.38);
        item_manway(item, p, vec(0, 0, 1), 0.22, 0.2);
    }
}

void tank_build(struct site *site, const char *name, struct frame at, const struct tank_spec *spec)
{
    struct item item = item_begin(&site->model, name, at);
    item.necks = item_part(&item, "nozzles", MATERIAL_TANK);
    item.flanges = item_part(&item, "flanges", MATERIAL_BOLTING);
    shape_sector(item_part(&site->civil, "plinths", MATERIAL_PLINTH), at, spec->r - 0.5, spec->r + 0.35, -0.05, BASE_M, 0, 360, 64);
    tank_shell(&item, spec);
    struct item access = item_begin_group(&site->access, name, at);
    tank_stair(&access, spec);
    tank_roof(&item, &access, spec);
    item_end(&access);
    item_nozzle(&item, "N1", vec(-spec->r, 0, BASE_M + 0.45), vec(-1, 0, 0), 0.084, 0.25);
    item_nozzle(&item, "N2", vec_polar(spec->r, 120, BASE_M + spec->height - 0.55), vec_polar(1, 120, 0), 0.057, 0.25);
    item_manway(&item, vec_polar(spec->r, 225, BASE_M + 0.75), vec_polar(1, 225, 0), 0.30, 0.25);
    struct vec low = vec_polar(spec->r + 0.03, 200, BASE_M + 0.6), high = vec_polar(spec->r + 0.03, 200, BASE_M + spec->height - 0.4);
    struct frame board = frame_facing(low, vec_sub(high, low), vec_polar(1, 200, 0));
    struct mesh *level = item_part(&item, "level board", MATERIAL_INSTRUMENT);
    shape_block(level, board, 0, 0.02, -0.11, 0.11, 0, vec_length(vec_sub(high, low)));
    for (int i = 1; i <= 3; i++) /* brackets */
        shape_block(level, board, -0.08, 0.01, -0.06, 0.06, i * spec->height * 0.2, i * spec->height * 0.2 + 0.05);
    item_end(&item);
}
