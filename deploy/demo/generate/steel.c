/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Beams, gratings, handrails, ladders, stairs and ring platforms, all of cheap geometry. */
#include "steel.h"

#include "shape.h"

#define RAIL_HEIGHT_M 1.10
#define UP vec(0, 0, 1)

void steel_beam(struct mesh *mesh, struct vec a, struct vec b, struct vec up, double depth, double width)
{
    struct frame at = frame_facing(a, vec_sub(b, a), up);
    double length = vec_length(vec_sub(b, a)), web = depth * 0.04, flange = depth * 0.07;
    shape_block(mesh, at, -depth / 2, depth / 2, -web / 2, web / 2, 0, length);
    shape_block(mesh, at, depth / 2 - flange, depth / 2, -width / 2, width / 2, 0, length);
    shape_block(mesh, at, -depth / 2, -depth / 2 + flange, -width / 2, width / 2, 0, length);
}

void steel_column(struct mesh *mesh, double x, double y, double z0, double z1, double depth)
{
    steel_beam(mesh, vec(x, y, z0), vec(x, y, z1), vec(1, 0, 0), depth, depth);
    shape_block(mesh, frame_at(x, y, z0), -depth * 0.8, depth * 0.8, -depth * 0.8, depth * 0.8, 0, 0.03);
}

void steel_floor(struct mesh *mesh, struct frame at, double x0, double x1, double y0, double y1, double z)
{
    const double gap = 0.008;
    int columns = (int)fmax(1.0, round((x1 - x0) / 1.0)), rows = (int)fmax(1.0, round((y1 - y0) / 1.5));
    double wide = (x1 - x0) / columns, deep = (y1 - y0) / rows;
    for (int i = 0; i < columns; i++)
        for (int j = 0; j < rows; j++)
            shape_block(mesh, at, x0 + wide * i + gap, x0 + wide * (i + 1) - gap, y0 + deep * j + gap, y0 + deep * (j + 1) - gap,
                        z - 0.035, z);
}

static void rail_span(struct mesh *mesh, struct vec a, struct vec b, bool toe)
{
    shape_bar(mesh, vec_along(a, UP, RAIL_HEIGHT_M), vec_along(b, UP, RAIL_HEIGHT_M), 0.022, 6);
    shape_bar(mesh, vec_along(a, UP, RAIL_HEIGHT_M / 2), vec_along(b, UP, RAIL_HEIGHT_M / 2), 0.018, 6);
    if (!toe)
        return;
    struct frame at = frame_facing(a, vec_sub(b, a), UP);
    shape_block(mesh, at, 0.005, 0.10, -0.004, 0.004, 0, vec_length(vec_sub(b, a)));
}

static void rail_post(struct mesh *mesh, struct vec foot)
{
    shape_bar(mesh, vec_along(foot, UP, -0.05), vec_along(foot, UP, RAIL_HEIGHT_M + 0.022), 0.022, 6);
}

void steel_handrail(struct mesh *mesh, const struct vec *points, int count)
{
    rail_post(mesh, points[0]);
    for (int i = 0; i + 1 < count; i++) {
        struct vec d = vec_sub(points[i + 1], points[i]);
        int pieces = (int)fmax(1.0, round(vec_length(d) / 1.5));
        rail_span(mesh, points[i], points[i + 1], fabs(d.z) < 1e-6);
        for (int k = 1; k <= pieces; k++)
            rail_post(mesh, vec_along(points[i], d, (double)k / pieces));
    }
}

static void ladder_cage(struct mesh *mesh, struct frame at, double height)
{
    const double r = 0.36, first = 2.3;
    int hoops = (int)((height + RAIL_HEIGHT_M - first) / 1.0) + 1;
    struct frame centre = frame_moved(at, 0, r, 0);
    for (int i = 0; i < hoops; i++)
        shape_sector(mesh, centre, r - 0.004, r + 0.004, first + i - 0.025, first + i + 0.025, -60, 240, 10);
    double top = first + hoops - 1.0;
    for (int i = 0; i < 5; i++) {
        struct vec p = vec_polar(r, -30.0 + 60.0 * i, 0);
        shape_bar(mesh, frame_point(&centre, vec(p.x, p.y, first)), frame_point(&centre, vec(p.x, p.y, top)), 0.010, 4);
    }
}

void steel_ladder(struct mesh *mesh, struct frame at, double height)
{
    for (int side = -1; side <= 1; side += 2)
        shape_block(mesh, at, side * 0.23 - 0.006, side * 0.23 + 0.006, -0.03, 0.03, 0, height + RAIL_HEIGHT_M);
    for (double z = 0.3; z <= height + 0.01; z += 0.3)
        shape_bar(mesh, frame_point(&at, vec(-0.23, 0, z)), frame_point(&at, vec(0.23, 0, z)), 0.011, 5);
    if (height > 3.0)
        ladder_cage(mesh, at, height);
}

void steel_stair(struct mesh *steel, struct mesh *rail, struct vec foot, struct vec head, double width)
{
    struct vec run = vec(head.x - foot.x, head.y - foot.y, 0), ahead = vec_unit(run), side = vec_cross(UP, ahead);
    int steps = (int)round((head.z - foot.z) / 0.19);
    for (int i = 1; i <= steps; i++) {
        struct frame tread = frame_facing(vec_lerp(foot, head, (double)i / steps), UP, ahead);
        shape_block(steel, tread, -0.14, 0.12, -width / 2, width / 2, -0.03, 0);
    }
    for (int k = -1; k <= 1; k += 2) {
        struct vec a = vec_along(foot, side, k * width / 2), b = vec_along(head, side, k * width / 2);
        struct frame stringer = frame_facing(a, vec_sub(b, a), UP);
        shape_block(steel, stringer, -0.13, 0.07, -0.012, 0.012, 0, vec_length(vec_sub(b, a)));
        steel_handrail(rail, (struct vec[]){ a, b }, 2);
    }
}

void steel_ring_platform(struct mesh *steel, struct mesh *rail, struct frame at, double r0, double r1, double from_deg, double to_deg)
{
    const double panel_deg = 15.0;
    int panels = (int)round((to_deg - from_deg) / panel_deg);
    bool whole = to_deg - from_deg > 359.0;
    struct vec points[32];
    int count = 0;
    if (!whole)
        points[count++] = frame_point(&at, vec_polar(r0 + 0.05, from_deg, 0));
    for (int i = 0; i <= panels; i++) {
        double a = from_deg + (to_deg - from_deg) * i / panels;
        points[count++] = frame_point(&at, vec_polar(r1, a, 0));
        if (i == panels)
            break;
        shape_sector(steel, at, r0, r1, -0.035, 0, a + 0.15, a + panel_deg - 0.15, 1);
        if (i % 3 == 1) /* bracket: a strut back to the shell */
            shape_bar(steel, frame_point(&at, vec_polar(r1 - 0.1, a, -0.04)), frame_point(&at, vec_polar(r0 - 0.06, a, -0.85)), 0.035, 6);
    }
    if (!whole)
        points[count++] = frame_point(&at, vec_polar(r0 + 0.05, to_deg, 0));
    shape_sector(steel, at, r1 - 0.01, r1 + 0.01, -0.16, 0.005, from_deg, to_deg, panels);
    steel_handrail(rail, points, count);
}
