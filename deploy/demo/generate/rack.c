/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pipe rack. */
#include "context.h"
#include "shape.h"
#include "steel.h"

#define UP vec(0, 0, 1)

static double bent_x(int i)
{
    return RACK_BENT_M * (i - (RACK_BENT_COUNT - 1) / 2.0);
}

static void bent(struct site *site, struct item *item, double x)
{
    struct mesh *steel = item_part(item, "steel", MATERIAL_STRUCTURE), *proof = item_part(item, "fireproofing", MATERIAL_PLINTH);
    const double levels[] = { RACK_LOW_M, RACK_HIGH_M, RACK_TOP_M };
    for (int side = 0; side < 2; side++) {
        double y = side ? RACK_NORTH_M : RACK_SOUTH_M;
        steel_column(steel, x, y, 0.2, RACK_TOP_M, 0.30);
        shape_block(proof, frame_at(x, y, 0), -0.22, 0.22, -0.22, 0.22, 0.2, 3.2);
        civil_plinth(site, frame_at(x, y, 0), -0.4, 0.4, -0.4, 0.4, 0.2);
    }
    for (int i = 0; i < 3; i++)
        steel_beam(steel, vec(x, RACK_SOUTH_M, levels[i] - 0.18), vec(x, RACK_NORTH_M, levels[i] - 0.18), UP, 0.36, 0.22);
}

static void cable_tray(struct item *item, double y, double z, double width)
{
    struct mesh *tray = item_part(item, "cable trays", MATERIAL_GALVANISED), *cable = item_part(item, "cables", MATERIAL_BLACK);
    double x0 = bent_x(0) - 0.6, x1 = bent_x(RACK_BENT_COUNT - 1) + 0.6;
    for (int side = -1; side <= 1; side += 2)
        shape_block(tray, frame_at(0, y + side * width / 2, z), x0, x1, -0.004, 0.004, 0, 0.10);
    for (double x = x0; x < x1; x += 0.6)
        shape_block(tray, frame_at(x, y, z), 0, 0.05, -width / 2, width / 2, 0, 0.012);
    for (int i = 0; i < 4; i++)
        shape_cylinder(cable, frame_facing(vec(x0 + 0.1, y - width * 0.3 + width * 0.18 * i, z + 0.035), vec(1, 0, 0), UP), 0.024,
                       x1 - x0 - 0.2, 6, 6);
}

void rack_build(struct site *site, const char *name)
{
    struct item item = item_begin(&site->model, name, frame_at(0, 0, 0));
    struct mesh *steel = item_part(&item, "steel", MATERIAL_STRUCTURE);
    for (int i = 0; i < RACK_BENT_COUNT; i++)
        bent(site, &item, bent_x(i));
    for (int i = 0; i + 1 < RACK_BENT_COUNT; i++)
        for (int side = 0; side < 2; side++) {
            double y = side ? RACK_NORTH_M : RACK_SOUTH_M, x0 = bent_x(i), x1 = bent_x(i + 1);
            steel_beam(steel, vec(x0, y, (RACK_LOW_M + RACK_HIGH_M) / 2 - 0.2), vec(x1, y, (RACK_LOW_M + RACK_HIGH_M) / 2 - 0.2), UP,
                       0.28, 0.16);
            steel_beam(steel, vec(x0, y, RACK_TOP_M - 0.16), vec(x1, y, RACK_TOP_M - 0.16), UP, 0.32, 0.18);
            if (i == 1 || i == 4) {
                shape_bar(steel, vec(x0, y, 3.3), vec((x0 + x1) / 2, y, RACK_HIGH_M - 1.2), 0.05, 6);
                shape_bar(steel, vec(x1, y, 3.3), vec((x0 + x1) / 2, y, RACK_HIGH_M - 1.2), 0.05, 6);
            }
        }
    cable_tray(&item, RACK_NORTH_M - 0.7, RACK_TOP_M + 0.02, 0.6);
    cable_tray(&item, RACK_NORTH_M - 1.5, RACK_TOP_M + 0.02, 0.45);
    item_end(&item);
}
