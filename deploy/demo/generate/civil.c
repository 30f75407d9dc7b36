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
    const double joint = 0.014;
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

static void lamp_pole(struct site *site, double x, double y, double towards_deg)
{
    struct mesh *steel = item_part(&site->civil, "lamp poles", MATERIAL_GALVANISED);
    struct frame at = frame_turned(frame_at(x, y, 0), towards_deg);
    civil_plinth(site, at, -0.25, 0.25, -0.25, 0.25, 0.25);
    shape_tube(steel, at, 0.075, 0.045, 7.5, 10, 0);
    shape_bar(steel, frame_point(&at, vec(0, 0, 7.45)), frame_point(&at, vec(0.9, 0, 7.75)), 0.03, 8);
    shape_block(steel, at, 0.75, 1.35, -0.15, 0.15, 7.70, 7.80);
    shape_block(item_part(&site->civil, "lamps", MATERIAL_TANK), at, 0.80, 1.30, -0.12, 0.12, 7.685, 7.70);
}

static void fire_monitor(struct site *site, double x, double y, double towards_deg)
{
    struct mesh *red = item_part(&site->civil, "fire monitors", MATERIAL_HANDWHEEL);
    struct frame at = frame_turned(frame_at(x, y, 0), towards_deg);
    shape_cylinder(red, at, 0.085, 1.0, 16, 0);
    shape_cylinder(red, frame_moved(at, 0, 0, 0.55), 0.15, 0.05, 16, 0);
    shape_cylinder(red, frame_moved(at, 0, 0, 1.0), 0.12, 0.16, 16, 0);
    struct frame barrel = frame_facing(frame_point(&at, vec(0, 0, 1.12)), frame_dir(&at, vec(0.86, 0, 0.5)), vec(0, 0, 1));
    shape_tube(red, barrel, 0.075, 0.045, 0.75, 14, 0);
    shape_torus(red, frame_facing(frame_point(&at, vec(-0.22, 0, 1.08)), at.x, at.z), 0.13, 0.012, 0, 360, 16, 6);
    shape_bar(red, frame_point(&at, vec(-0.22, 0, 1.08)), frame_point(&at, vec(0, 0, 1.08)), 0.015, 6);
}

/* A drain channel with a grated cover, along x. */
static void gutter(struct item *item, double x0, double x1, double y)
{
    struct mesh *grate = item_part(item, "gutters", MATERIAL_GALVANISED), *frame = item_part(item, "joints", MATERIAL_JOINT);
    shape_block(frame, frame_at(0, y, 0), x0, x1, -0.20, 0.20, -0.05, 0.004);
    for (double x = x0; x < x1 - 0.1; x += 1.0)
        shape_block(grate, frame_at(x, y, 0), 0.01, fmin(1.0, x1 - x) - 0.01, -0.17, 0.17, -0.02, 0.008);
}

void civil_build(struct site *site)
{
    const double around = 2.5;
    site->civil = item_begin(&site->model, "CIVIL", frame_at(0, 0, 0));
    slab(&site->civil);
    struct mesh *gravel = item_part(&site->civil, "gravel", MATERIAL_GRAVEL);
    field(gravel, GRADE_WEST_M - around, GRADE_EAST_M + around, GRADE_SOUTH_M - around, GRADE_NORTH_M + around, -0.12, 2.0);
    struct mesh *marks = item_part(&site->civil, "walkway marks", MATERIAL_SAFETY_YELLOW); /* the way along the rack and to the pumps */
    for (int side = 0; side < 2; side++)
        field(marks, GRADE_WEST_M + 1.0, GRADE_EAST_M - 1.0, -0.75 - 1.5 * side, -0.65 - 1.5 * side, 0.006, 2.0);
    gutter(&site->civil, -19.0, 5.0, -12.3);
    lamp_pole(site, -20.2, 5.6, -45);
    lamp_pole(site, 7.2, -1.2, 135);
    lamp_pole(site, 19.9, -0.6, 180);
    fire_monitor(site, -19.9, -3.4, 20);
    fire_monitor(site, 7.6, -2.0, 130);
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
