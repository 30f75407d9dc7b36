/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ground: slab panels with open joints, kerbs, plinths, gravel around, walkway marks. */
#include "context.h"
#include "shape.h"

#define PANEL_M 3.0

/* A level rectangle in squares of about `step`. */
static void field(struct mesh *mesh, double x0, double x1, double y0, double y1, double z, double step)
{
    int columns = (int)ceil((x1 - x0) / step), rows = (int)ceil((y1 - y0) / step);
    uint32_t first = (uint32_t)mesh->vertex_count;
    for (int j = 0; j <= rows; j++)
        for (int i = 0; i <= columns; i++)
            mesh_vertex(mesh, vec(x0 + (x1 - x0) * i / columns, y0 + (y1 - y0) * j / rows, z), vec(0, 0, 1));
    for (int j = 0; j < rows; j++)
        for (int i = 0; i < columns; i++) {
            uint32_t a = first + (uint32_t)(j * (columns + 1) + i), d = a + (uint32_t)columns + 1;
            mesh_triangle(mesh, a, a + 1, d + 1);
            mesh_triangle(mesh, a, d + 1, d);
        }
}

static void slab(struct item *item)
{
    const double joint = 0.02;
    struct mesh *concrete = item_part(item, "slab", MATERIAL_CONCRETE);
    field(item_part(item, "joints", MATERIAL_JOINT), GRADE_WEST_M, GRADE_EAST_M, GRADE_SOUTH_M, GRADE_NORTH_M, -0.025, 3.0);
    for (double x = GRADE_WEST_M; x < GRADE_EAST_M - 0.1; x += PANEL_M)
        for (double y = GRADE_SOUTH_M; y < GRADE_NORTH_M - 0.1; y += PANEL_M) {
            double x1 = fmin(x + PANEL_M, GRADE_EAST_M), y1 = fmin(y + PANEL_M, GRADE_NORTH_M);
            field(concrete, x + joint, x1 - joint, y + joint, y1 - joint, 0, 1.0);
        }
    shape_block(concrete, frame_at(0, 0, 0), GRADE_WEST_M - 0.15, GRADE_EAST_M + 0.15, GRADE_SOUTH_M - 0.15, GRADE_SOUTH_M, -0.4, 0.10);
    shape_block(concrete, frame_at(0, 0, 0), GRADE_WEST_M - 0.15, GRADE_EAST_M + 0.15, GRADE_NORTH_M, GRADE_NORTH_M + 0.15, -0.4, 0.10);
    shape_block(concrete, frame_at(0, 0, 0), GRADE_WEST_M - 0.15, GRADE_WEST_M, GRADE_SOUTH_M, GRADE_NORTH_M, -0.4, 0.10);
    shape_block(concrete, frame_at(0, 0, 0), GRADE_EAST_M, GRADE_EAST_M + 0.15, GRADE_SOUTH_M, GRADE_NORTH_M, -0.4, 0.10);
}

void civil_build(struct site *site)
{
    const double around = 4.0;
    site->civil = item_begin(&site->model, "CIVIL", frame_at(0, 0, 0));
    slab(&site->civil);
    struct mesh *gravel = item_part(&site->civil, "gravel", MATERIAL_GRAVEL);
    field(gravel, GRADE_WEST_M - around, GRADE_EAST_M + around, GRADE_SOUTH_M - around, GRADE_NORTH_M + around, -0.12, 2.0);
    struct mesh *marks = item_part(&site->civil, "walkway marks", MATERIAL_SAFETY_YELLOW); /* the way along the rack and to the pumps */
    for (int side = 0; side < 2; side++)
        field(marks, GRADE_WEST_M + 1.0, GRADE_EAST_M - 1.0, -0.75 - 1.5 * side, -0.65 - 1.5 * side, 0.006, 2.0);
}

void civil_kerb(struct site *site, double x0, double x1, double y0, double y1, double height)
{
    const double thick = 0.15;
    struct mesh *kerb = item_part(&site->civil, "kerbs", MATERIAL_PLINTH);
    struct frame at = frame_at(0, 0, 0);
    shape_block(kerb, at, x0 - thick, x1 + thick, y0 - thick, y0, -0.1, height);
    shape_block(kerb, at, x0 - thick, x1 + thick, y1, y1 + thick, -0.1, height);
    shape_block(kerb, at, x0 - thick, x0, y0, y1, -0.1, height);
    shape_block(kerb, at, x1, x1 + thick, y0, y1, -0.1, height);
}

void civil_plinth(struct site *site, struct frame at, double x0, double x1, double y0, double y1, double height)
{
    struct mesh *plinth = item_part(&site->civil, "plinths", MATERIAL_PLINTH);
    shape_block(plinth, at, x0, x1, y0, y1, -0.1, height - 0.012);
    shape_block(plinth, at, x0 + 0.015, x1 - 0.015, y0 + 0.015, y1 - 0.015, height - 0.012, height); /* chamfer */
}
