/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The two-storey steel structure that carries the reflux drum and the trim condenser. */
#include "context.h"
#include "shape.h"
#include "steel.h"

#define UP vec(0, 0, 1)

static const double column_x[] = { STRUCTURE_WEST_M, (STRUCTURE_WEST_M + STRUCTURE_EAST_M) / 2, STRUCTURE_EAST_M };
static const double row_y[] = { STRUCTURE_SOUTH_M, STRUCTURE_NORTH_M };

static void frame_level(struct mesh *steel, double z)
{
    double middle = z - 0.035 - 0.17;
    for (int j = 0; j < 2; j++)
        steel_beam(steel, vec(column_x[0], row_y[j], middle), vec(column_x[2], row_y[j], middle), UP, 0.34, 0.2);
    for (int i = 0; i < 3; i++)
        steel_beam(steel, vec(column_x[i], row_y[0], middle), vec(column_x[i], row_y[1], middle), UP, 0.34, 0.2);
    for (int i = 0; i < 6; i++) { /* secondary beams */
        double x = column_x[0] + (column_x[2] - column_x[0]) * (i + 0.5) / 6;
        steel_beam(steel, vec(x, row_y[0], z - 0.13), vec(x, row_y[1], z - 0.13), UP, 0.18, 0.1);
    }
}

static void brace(struct mesh *steel, struct vec a, struct vec b)
{
    shape_bar(steel, a, b, 0.055, 8);
}

static void floor_level(struct item *item, double z, double gap_from, double gap_to)
{
    struct mesh *steel = item_part(item, "floors", MATERIAL_GALVANISED), *rail = item_part(item, "handrails", MATERIAL_SAFETY_YELLOW);
    const double over = 0.45, w = column_x[0] - over, e = column_x[2] + over, s = row_y[0] - over, n = row_y[1] + over;
    steel_floor(steel, frame_at(0, 0, 0), w, e, s, n, z);
    const struct vec points[] = { vec(gap_to, s, z), vec(e, s, z), vec(e, n, z), vec(w, n, z), vec(w, s, z), vec(gap_from, s, z) };
    int first = gap_to >= e ? 1 : 0; /* the gap where the stair arrives on the south side */
    steel_handrail(rail, points + first, 6 - first);
}

void structure_build(struct site *site, const char *name)
{
    struct item item = item_begin(&site->model, name, frame_at(0, 0, 0));
    struct mesh *steel = item_part(&item, "steel", MATERIAL_STRUCTURE), *grate = item_part(&item, "floors", MATERIAL_GALVANISED);
    struct mesh *rail = item_part(&item, "handrails", MATERIAL_SAFETY_YELLOW), *proof = item_part(&item, "fireproofing", MATERIAL_PLINTH);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 2; j++) {
            steel_column(steel, column_x[i], row_y[j], 0.2, STRUCTURE_HIGH_M - 0.04, 0.30);
            shape_block(proof, frame_at(column_x[i], row_y[j], 0), -0.22, 0.22, -0.22, 0.22, 0.2, 2.6);
            civil_plinth(site, frame_at(column_x[i], row_y[j], 0), -0.4, 0.4, -0.4, 0.4, 0.2);
        }
    frame_level(steel, STRUCTURE_LOW_M);
    frame_level(steel, STRUCTURE_HIGH_M);
    brace(steel, vec(column_x[1], row_y[1], 0.5), vec(column_x[2], row_y[1], STRUCTURE_LOW_M - 0.4));
    brace(steel, vec(column_x[2], row_y[0], 0.5), vec(column_x[2], row_y[1], STRUCTURE_LOW_M - 0.4));
    brace(steel, vec(column_x[0], row_y[0], STRUCTURE_LOW_M), vec(column_x[0], row_y[1], STRUCTURE_HIGH_M - 0.4));
    brace(steel, vec(column_x[1], row_y[1], STRUCTURE_LOW_M), vec(column_x[2], row_y[1], STRUCTURE_HIGH_M - 0.4));

    const double south = row_y[0] - 0.45, lane = south - 0.5, run = 5.6;
    double low_x = 3.8, high_x = low_x - run; /* the flight climbs towards west, the next one above it towards east */
    floor_level(&item, STRUCTURE_LOW_M, high_x - 1.0, high_x + 1.2);
    floor_level(&item, STRUCTURE_HIGH_M, 3.4, 4.6);
    steel_stair(grate, rail, vec(low_x, lane, 0), vec(high_x, lane, STRUCTURE_LOW_M), 0.8);
    steel_floor(grate, frame_at(0, 0, 0), high_x - 1.0, high_x, lane - 0.4, south, STRUCTURE_LOW_M);
    steel_handrail(rail, (struct vec[]){ vec(high_x - 1.0, south, STRUCTURE_LOW_M), vec(high_x - 1.0, lane - 0.4, STRUCTURE_LOW_M),
                                         vec(high_x, lane - 0.4, STRUCTURE_LOW_M) }, 3);
    struct vec foot = vec(4.0, south - 0.12, STRUCTURE_LOW_M);
    steel_ladder(grate, frame_facing(foot, UP, vec(-1, 0, 0)), STRUCTURE_HIGH_M - STRUCTURE_LOW_M);
    item_end(&item);
}
