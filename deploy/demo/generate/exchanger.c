/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shell-and-tube exchangers: removable-cover channel, insulated shell, floating-head cover; and the kettle reboiler. */
#include "equipment.h"
#include "fitting.h"
#include "saddle.h"
#include "shape.h"

#define INSULATION_M 0.06
#define BARE_M 0.22 /* of shell next to a girth flange, left open for the bolts */

static struct frame along_axis(double x, double axis_z)
{
    return frame_facing(vec(x, 0, axis_z), vec(1, 0, 0), vec(0, 0, 1));
}

/* A pair of girth flanges whose joint lies at x, with studs and nuts. */
static void girth_flanges(struct mesh *mesh, double x, double axis_z, double r, int sides, int studs)
{
    const double thick = 0.075, outer = r + 0.115;
    struct frame at = along_axis(x, axis_z);
    for (int side = -1; side <= 1; side += 2) {
        struct frame face = frame_facing(at.o, vec_scale(at.z, side), at.x);
        struct profile profile = { 0 };
        profile_edge(&profile, r * 0.98, 0.004);
        profile_edge(&profile, outer - 0.05, 0.004);
        profile_edge(&profile, outer, 0.008);
        profile_edge(&profile, outer, thick);
        profile_edge(&profile, r + 0.028, thick + 0.002);
        profile_edge(&profile, r - 0.001, thick + 0.085);
        shape_revolve(mesh, face, &profile, sides, 0);
    }
    for (int i = 0; i < studs; i++) {
        struct frame stud = frame_moved(frame_turned(at, 360.0 * (i + 0.5) / studs), r + 0.075, 0, 0);
        if (sides < 64) { /* plain bolts */
            shape_hexagon(mesh, stud, 0.024, -thick - 0.035, thick + 0.035);
            continue;
        }
        shape_cylinder(mesh, frame_moved(stud, 0, 0, -thick - 0.055), 0.013, 2 * (thick + 0.055), 8, 0);
        shape_hexagon(mesh, stud, 0.024, thick - 0.005, thick + 0.03);
        shape_hexagon(mesh, stud, 0.024, -thick - 0.03, -thick + 0.005);
    }
}

/* Flat cover bolted on the channel, seen from -x. */
static void channel_cover(struct mesh *mesh, double x, double axis_z, double r, int sides)
{
    struct frame out = frame_facing(vec(x, 0, axis_z), vec(-1, 0, 0), vec(0, 0, 1));
    struct profile profile = { 0 };
    profile_edge(&profile, r + 0.112, 0.0);
    profile_edge(&profile, r + 0.112, 0.06);
    profile_edge(&profile, r + 0.02, 0.06);
    profile_edge(&profile, r - 0.02, 0.075);
    profile_edge(&profile, 0.0, 0.075);
    shape_revolve(mesh, out, &profile, sides, 0.16);
}

static void lugs_and_bands(struct mesh *mesh, const struct exchanger_spec *spec)
{
    double half = spec->length / 2;
    int bands = (int)round(spec->length / 0.55);
    for (int i = 0; i <= bands; i++) {
        double x = -half + BARE_M + 0.08 + (spec->length - 2 * BARE_M - 0.16) * i / bands;
        shape_band(mesh, along_axis(x, spec->axis_z), spec->r, 0.04, spec->sides);
    }
    struct frame plate = frame_facing(vec(-half * 0.35, -spec->r * 0.94, spec->axis_z + spec->r * 0.34), vec(0, -0.94, 0.34), vec(0, 0, 1));
    shape_block(mesh, plate, -0.09, 0.09, -0.13, 0.13, -0.06, 0.012); /* name plate on its bracket */
    for (int i = -1; i <= 1; i += 2) {                               /* lifting lugs on the channel and rear cover */
        struct frame lug = frame_facing(vec(i * (half + 0.33), 0, spec->axis_z + spec->r - INSULATION_M + 0.045), vec(0, 1, 0),
                                        vec(0, 0, 1));
        shape_torus(mesh, lug, 0.045, 0.014, 0, 360, 14, 8);
    }
}

static void exchanger_shell(struct mesh *shell, struct mesh *heads, const struct exchanger_spec *spec)
{
    double bare = spec->r - INSULATION_M, half = spec->length / 2;
    struct profile cladding = { 0 };
    profile_edge(&cladding, bare, BARE_M);
    profile_edge(&cladding, spec->r - 0.004, BARE_M);
    profile_laps(&cladding, spec->r, BARE_M + 0.004, spec->length - BARE_M, 0.9);
    profile_edge(&cladding, bare, spec->length - BARE_M);
    shape_revolve(shell, along_axis(-half, spec->axis_z), &cladding, spec->sides, spec->step);
    for (int i = 0; i < 2; i++)
        shape_tube(heads, along_axis(i ? half - BARE_M - 0.02 : -half, spec->axis_z), bare, bare, BARE_M + 0.02, spec->sides, spec->step);
}

static void exchanger_heads(struct mesh *heads, const struct exchanger_spec *spec, double channel, double rear)
{
    double bare = spec->r - INSULATION_M, half = spec->length / 2;
    shape_tube(heads, along_axis(-half - channel, spec->axis_z), bare, bare, channel, spec->sides, spec->step);
    channel_cover(heads, -half - channel - 0.004, spec->axis_z, bare, spec->sides);
    struct profile cover = { 0 };
    profile_edge(&cover, bare, 0);
    profile_smooth(&cover, bare, rear);
    profile_dome(&cover, bare, rear, bare * 0.5, 14);
    shape_revolve(heads, along_axis(half, spec->axis_z), &cover, spec->sides, spec->step);
}

void exchanger_build(struct site *site, const char *name, struct frame at, const struct exchanger_spec *spec)
{
    const double channel = 0.62 + spec->r * 0.25, rear = 0.28, bare = spec->r - INSULATION_M, half = spec->length / 2;
    struct item item = item_begin(&site->model, name, at);
    struct mesh *heads = item_part(&item, "heads", MATERIAL_CHANNEL), *flanges = item_part(&item, "flanges", MATERIAL_BOLTING);
    item.necks = item_part(&item, "saddles and nozzles", MATERIAL_PIPE);
    item.flanges = flanges;
    exchanger_shell(item_part(&item, "shell", spec->shell), heads, spec);
    exchanger_heads(heads, spec, channel, rear);
    lugs_and_bands(item_part(&item, "fittings", MATERIAL_STAINLESS), spec);
    girth_flanges(flanges, -half, spec->axis_z, bare, spec->sides, spec->studs);
    girth_flanges(flanges, half, spec->axis_z, bare, spec->sides, spec->studs);
    girth_flanges(flanges, -half - channel, spec->axis_z, bare, spec->sides, spec->studs);

    double tube_x = -half - channel / 2 - 0.02, shell_x = half - BARE_M - spec->shell_nozzle_r - 0.2;
    item_nozzle(&item, "N1", vec(tube_x, 0, spec->axis_z - bare), vec(0, 0, -1), spec->tube_nozzle_r, 0.22);
    item_nozzle(&item, "N2", vec(tube_x, 0, spec->axis_z + bare), vec(0, 0, 1), spec->tube_nozzle_r, 0.24);
    item_nozzle(&item, "N3", vec(shell_x, 0, spec->axis_z + spec->r), vec(0, 0, 1), spec->shell_nozzle_r, 0.24);
    item_nozzle(&item, "N4", vec(-shell_x, 0, spec->axis_z - spec->r), vec(0, 0, -1), spec->shell_nozzle_r, 0.22);
    for (int i = -1; i <= 1; i += 2) {
        double x = i * spec->length * 0.27, wide = spec->r * 0.88 + 0.14;
        saddle_build(item.necks, x, spec->axis_z, spec->base_z, spec->r);
        if (spec->base_z < 1.0)
            civil_plinth(site, at, x - 0.24, x + 0.24, -wide, wide, spec->base_z);
    }
    item_end(&item);
}

void kettle_build(struct site *site, const char *name, struct frame at)
{
    const double small = 0.46, large = 0.82, axis_z = 1.75, shift = large - small, bundle = 0.55, cone = 0.75, body = 3.6, base_z = 0.75;
    const int sides = 56;
    struct item item = item_begin(&site->model, name, at);
    struct mesh *shell = item_part(&item, "shell", MATERIAL_CLADDING), *heads = item_part(&item, "heads", MATERIAL_CHANNEL);
    item.necks = item_part(&item, "saddles and nozzles", MATERIAL_PIPE);
    item.flanges = item_part(&item, "flanges", MATERIAL_BOLTING);
    double x0 = -body / 2, low_z = axis_z - shift; /* the bundle lies on the bottom line */
    shape_reducer(shell, along_axis(x0 - cone, low_z), small, large, shift, cone, sides, 0.1);
    struct profile sleeve = { 0 };
    profile_edge(&sleeve, small - 0.06, 0);
    profile_edge(&sleeve, small, 0);
    profile_edge(&sleeve, small, bundle - 0.16);
    shape_revolve(shell, along_axis(x0 - cone - bundle + 0.16, low_z), &sleeve, sides, 0.1);
    struct profile profile = { 0 };
    profile_laps(&profile, large, 0, body - 0.05, 0.9);
    profile_smooth(&profile, large, body);
    profile_dome(&profile, large, body, large * 0.5, 12);
    shape_revolve(shell, along_axis(x0, axis_z), &profile, sides, 0.1);

    double joint = x0 - cone - bundle, bare = small - 0.05;
    shape_tube(heads, along_axis(joint, low_z), bare, bare, 0.2, sides, 0.1);
    shape_tube(heads, along_axis(joint - 0.62, low_z), bare, bare, 0.62, sides, 0.1);
    channel_cover(heads, joint - 0.624, low_z, bare, sides);
    girth_flanges(item.flanges, joint, low_z, bare, sides, 20);
    girth_flanges(item.flanges, joint - 0.62, low_z, bare, sides, 20);
    item_nozzle(&item, "N1", vec(joint - 0.31, 0, low_z + bare), vec(0, 0, 1), 0.084, 0.24);
    item_nozzle(&item, "N2", vec(joint - 0.31, 0, low_z - bare), vec(0, 0, -1), 0.045, 0.15);
    item_nozzle(&item, "N3", vec(-0.2, 0, axis_z + large), vec(0, 0, 1), 0.162, 0.25);
    item_nozzle(&item, "N4", vec(x0 + 0.35, 0, axis_z - large), vec(0, 0, -1), 0.110, 0.18);
    item_nozzle(&item, "N5", vec(body / 2 - 0.2, 0, axis_z - large), vec(0, 0, -1), 0.084, 0.18);
    item_manway(&item, vec(1.2, 0, axis_z + large), vec(0, 0, 1), 0.25, 0.2);
    for (int i = -1; i <= 1; i += 2) {
        saddle_build(item.necks, i * 1.05, axis_z, base_z, large);
        civil_plinth(site, at, i * 1.05 - 0.24, i * 1.05 + 0.24, -0.86, 0.86, base_z);
    }
    for (int i = 0; i < 5; i++)
        shape_band(item_part(&item, "bands", MATERIAL_STAINLESS), along_axis(x0 + 0.35 + 0.72 * i, axis_z), large, 0.04, sides);
    item_end(&item);
}
