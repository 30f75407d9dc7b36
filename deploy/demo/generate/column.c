/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The distillation column: skirt, insulated shell, platforms, caged ladders, manways, nozzles, lifting davit. */
#include "equipment.h"
#include "fitting.h"
#include "shape.h"
#include "steel.h"

static void column_skirt(struct item *item, const struct column_spec *spec)
{
    struct mesh *skirt = item_part(item, "skirt", MATERIAL_VESSEL), *bolts = item_part(item, "bolts", MATERIAL_BOLTING);
    struct profile profile = { 0 };
    profile_edge(&profile, spec->r + 0.22, 0.30);
    profile_edge(&profile, spec->r + 0.22, 0.34);
    profile_edge(&profile, spec->r + 0.03, 0.34);
    profile_edge(&profile, spec->r - 0.02, spec->skirt + 0.1);
    shape_revolve(skirt, frame_at(0, 0, 0), &profile, 48, 0.25);
    shape_sector(skirt, frame_at(0, 0, 0), spec->r, spec->r + 0.2, 0.56, 0.59, 0, 360, 48); /* chair ring over the anchor bolts */
    for (int i = 0; i < 16; i++) {
        struct frame at = frame_turned(frame_at(0, 0, 0), 22.5 * i);
        shape_hexagon(bolts, frame_moved(at, spec->r + 0.14, 0, 0), 0.032, 0.32, 0.70);
        shape_block(skirt, frame_turned(at, 6), spec->r, spec->r + 0.19, -0.008, 0.008, 0.34, 0.56);
    }
    for (int i = 0; i < 2; i++) { /* access and pipe openings, framed */
        struct frame hole = frame_facing(vec_polar(spec->r - 0.05, 235.0 + 120.0 * i, 1.45), vec_polar(1, 235.0 + 120.0 * i, 0),
                                         vec(0, 0, 1));
        shape_tube(skirt, hole, 0.27, 0.27, 0.14, 24, 0);
        shape_cylinder(item_part(item, "openings", MATERIAL_BLACK), hole, 0.255, 0.09, 24, 0);
    }
}

static void column_shell(struct item *item, const struct column_spec *spec)
{
    struct profile profile = { 0 };
    profile_bowl(&profile, spec->r, spec->skirt, spec->r * 0.5, 8);
    profile_laps(&profile, spec->r, spec->skirt, spec->height - 0.02, 1.0);
    profile_smooth(&profile, spec->r, spec->height);
    profile_dome(&profile, spec->r, spec->height, spec->r * 0.5, 10);
    shape_revolve(item_part(item, "shell", MATERIAL_CLADDING), frame_at(0, 0, 0), &profile, 56, 0.26);
    struct mesh *bands = item_part(item, "bands", MATERIAL_STAINLESS);
    for (double z = spec->skirt + 0.5; z < spec->height; z += 1.0)
        shape_band(bands, frame_at(0, 0, z), spec->r, 0.045, 56);
}

/* item: a group of the access asset */
static void column_platforms(struct item *item, const struct column_spec *spec)
{
    struct mesh *steel = item_part(item, "platforms", MATERIAL_GALVANISED), *rail = item_part(item, "handrails", MATERIAL_SAFETY_YELLOW);
    const double top = spec->height + spec->r * 0.5 + 0.12;
    const struct {
        double z, from, to;
    } levels[] = { { 6.2, 150, 360 }, { 11.2, 150, 330 }, { 16.2, 150, 345 }, { top, 0, 360 } };
    double below = 0.0;
    for (int i = 0; i < 4; i++) {
        struct frame at = frame_at(0, 0, levels[i].z);
        double out = spec->r + (i == 3 ? 0.45 : 1.15);
        steel_ring_platform(steel, rail, at, i == 3 ? 0.35 : spec->r + 0.04, out, levels[i].from, levels[i].to);
        double deg = i % 2 ? 305.0 : 195.0, stand = i == 3 ? 0.65 : 1.28; /* ladders alternate between two sides */
        struct vec foot = vec_polar(spec->r + stand, deg, below);
        struct frame ladder = frame_facing(foot, vec(0, 0, 1), vec_polar(1, deg - 90.0, 0));
        steel_ladder(steel, ladder, levels[i].z - below);
        for (double z = below + 1.5; z < levels[i].z; z += 2.5)
            shape_bar(steel, vec(foot.x, foot.y, z), vec_polar(spec->r, deg, z), 0.02, 6);
        below = levels[i].z;
    }
    struct vec mast = vec_polar(spec->r + 0.30, 20.0, top); /* davit */
    shape_bar(rail, mast, vec_along(mast, vec(0, 0, 1), 2.3), 0.06, 10);
    shape_bar(rail, vec_along(mast, vec(0, 0, 1), 2.25), vec_polar(spec->r + 1.9, 20.0, top + 2.45), 0.05, 8);
    shape_bar(rail, vec_along(mast, vec(0, 0, 1), 1.5), vec_polar(spec->r + 1.2, 20.0, top + 2.35), 0.03, 6);
}

void column_build(struct site *site, const char *name, struct frame at, const struct column_spec *spec)
{
    struct item item = item_begin(&site->model, name, at);
    item.necks = item_part(&item, "nozzles", MATERIAL_PIPE);
    item.flanges = item_part(&item, "flanges", MATERIAL_BOLTING);
    struct frame octagon = frame_turned(frame_at(0, 0, 0), 22.5);
    double outline[8][2];
    for (int i = 0; i < 8; i++) {
        outline[i][0] = (spec->r + 0.55) * cos(RADIANS(45.0 * i));
        outline[i][1] = (spec->r + 0.55) * sin(RADIANS(45.0 * i));
    }
    struct frame pad = frame_in(&at, octagon);
    shape_prism(item_part(&site->civil, "plinths", MATERIAL_PLINTH), pad, (const double(*)[2])outline, 8, -0.1, 0.30);
    column_skirt(&item, spec);
    column_shell(&item, spec);
    struct item access = item_begin_group(&site->access, name, at);
    column_platforms(&access, spec);
    item_end(&access);

    double r = spec->r;
    item_nozzle(&item, "N1", vec(0, 0, spec->height + r * 0.5), vec(0, 0, 1), 0.162, 0.30);
    item_nozzle(&item, "N2", vec_polar(r, 60, spec->height - 0.9), vec_polar(1, 60, 0), 0.057, 0.22);
    item_nozzle(&item, "N3", vec_polar(r, 30, 10.4), vec_polar(1, 30, 0), 0.084, 0.22);
    item_nozzle(&item, "N4", vec_polar(r, 180, 4.6), vec_polar(1, 180, 0), 0.162, 0.25);
    struct frame outlet = frame_facing(vec(0, 0, spec->skirt - r * 0.5), vec(0, 0, -1), vec(1, 0, 0));
    item_connect(&item, "N5", outlet, 0.110); /* continuous pipe through the skirt, no flange inside it */
    const double manways[] = { 4.4, 7.2, 12.2, 17.2 };
    for (int i = 0; i < 4; i++) {
        double deg = i ? 250.0 : 270.0;
        item_manway(&item, vec_polar(r, deg, manways[i]), vec_polar(1, deg, 0), 0.26, 0.26);
    }
    item_end(&item);
}
