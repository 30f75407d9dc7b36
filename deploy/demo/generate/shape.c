/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Turned, swept, bent and straight solids. */
#include "shape.h"

#include <assert.h>

static void profile_push(struct profile *profile, double r, double z, bool smooth)
{
    assert(profile->count < PROFILE_MAX);
    profile->points[profile->count++] = (struct profile_point){ r, z, smooth };
}

void profile_edge(struct profile *profile, double r, double z)
{
    profile_push(profile, r, z, false);
}

void profile_smooth(struct profile *profile, double r, double z)
{
    profile_push(profile, r, z, true);
}

void profile_bowl(struct profile *profile, double r, double z, double height, int pieces)
{
    for (int i = pieces; i >= 0; i--)
        profile_push(profile, i == pieces ? 0.0 : r * cos(M_PI_2 * i / pieces), z - height * sin(M_PI_2 * i / pieces), true);
}

void profile_dome(struct profile *profile, double r, double z, double height, int pieces)
{
    for (int i = 0; i <= pieces; i++)
        profile_push(profile, i == pieces ? 0.0 : r * cos(M_PI_2 * i / pieces), z + height * sin(M_PI_2 * i / pieces), true);
}

void profile_laps(struct profile *profile, double r, double z0, double z1, double sheet)
{
    const double lap = 0.006;
    int sheets = (int)fmax(1.0, round((z1 - z0) / sheet));
    for (int i = 0; i < sheets; i++) {
        profile_edge(profile, r + (i ? lap : 0.0), z0 + (z1 - z0) * i / sheets);
        profile_edge(profile, r, z0 + (z1 - z0) * (i + 1) / sheets);
    }
}

struct slice { /* a ring of vertices, or one at the pole */
    uint32_t first;
    bool pole;
};

static struct slice slice_add(struct mesh *mesh, const struct frame *at, double r, double z, struct vec normal, int sides)
{
    struct slice slice = { (uint32_t)mesh->vertex_count, r < 1e-9 };
    if (slice.pole) {
        mesh_vertex(mesh, frame_point(at, vec(0, 0, z)), frame_dir(at, vec(0, 0, normal.z < 0.0 ? -1.0 : 1.0)));
        return slice;
    }
    for (int i = 0; i < sides; i++) {
        double c = cos(2.0 * M_PI * i / sides), s = sin(2.0 * M_PI * i / sides);
        mesh_vertex(mesh, frame_point(at, vec(r * c, r * s, z)), frame_dir(at, vec(normal.x * c, normal.x * s, normal.z)));
    }
    return slice;
}

static void slices_join(struct mesh *mesh, struct slice low, struct slice high, int sides)
{
    for (uint32_t i = 0; i < (uint32_t)sides; i++) {
        uint32_t next = (i + 1) % (uint32_t)sides;
        if (!low.pole)
            mesh_triangle(mesh, low.first + i, low.first + next, high.pole ? high.first : high.first + next);
        if (!high.pole)
            mesh_triangle(mesh, low.pole ? low.first : low.first + i, high.first + next, high.first + i);
    }
}

static struct vec profile_normal(const struct profile *profile, int segment)
{
    const struct profile_point *a = profile->points + segment, *b = a + 1;
    return vec_unit(vec(b->z - a->z, 0, a->r - b->r));
}

void shape_revolve(struct mesh *mesh, struct frame at, const struct profile *profile, int sides, double step)
{
    struct slice last = { 0, false };
    for (int i = 0; i + 1 < profile->count; i++) {
        const struct profile_point *a = profile->points + i, *b = a + 1;
        struct vec normal = profile_normal(profile, i), from = normal, to = normal;
        if (a->smooth && i > 0)
            from = vec_unit(vec_add(normal, profile_normal(profile, i - 1)));
        if (b->smooth && i + 2 < profile->count)
            to = vec_unit(vec_add(normal, profile_normal(profile, i + 1)));
        int pieces = step > 0.0 ? (int)fmax(1.0, ceil(hypot(b->r - a->r, b->z - a->z) / step - 1e-6)) : 1;
        if (i == 0 || !a->smooth)
            last = slice_add(mesh, &at, a->r, a->z, from, sides);
        for (int k = 1; k <= pieces; k++) {
            double t = (double)k / pieces;
            struct slice next = slice_add(mesh, &at, a->r + (b->r - a->r) * t, a->z + (b->z - a->z) * t, k == pieces ? to : normal, sides);
            slices_join(mesh, last, next, sides);
            last = next;
        }
    }
}

static void rim_fan(struct mesh *mesh, const struct frame *at, double r, double z, int sides, bool up)
{
    uint32_t first = (uint32_t)mesh->vertex_count;
    for (int i = 0; i < sides; i++)
        mesh_vertex(mesh, frame_point(at, vec_polar(r, 360.0 * i / sides, z)), vec_scale(at->z, up ? 1.0 : -1.0));
    for (uint32_t i = 1; i + 1 < (uint32_t)sides; i++)
        mesh_triangle(mesh, first, first + (up ? i : i + 1), first + (up ? i + 1 : i));
}

void shape_tube(struct mesh *mesh, struct frame at, double r0, double r1, double length, int sides, double step)
{
    struct profile profile = { 0 };
    profile_edge(&profile, r0, 0);
    profile_edge(&profile, r1, length);
    shape_revolve(mesh, at, &profile, sides, step);
}

void shape_cylinder(struct mesh *mesh, struct frame at, double r, double length, int sides, double step)
{
    shape_tube(mesh, at, r, r, length, sides, step);
    rim_fan(mesh, &at, r, 0, sides, false);
    rim_fan(mesh, &at, r, length, sides, true);
}

void shape_reducer(struct mesh *mesh, struct frame at, double r0, double r1, double shift, double length, int sides, double step)
{
    int pieces = step > 0.0 ? (int)fmax(1.0, ceil(length / step)) : 1;
    struct slice last = { 0, false };
    for (int k = 0; k <= pieces; k++) {
        double t = (double)k / pieces, r = r0 + (r1 - r0) * t;
        struct slice next = { (uint32_t)mesh->vertex_count, false };
        for (int i = 0; i < sides; i++) {
            struct vec out = vec_polar(1, 360.0 * i / sides, 0);
            struct vec slope = vec(shift + (r1 - r0) * out.x, (r1 - r0) * out.y, length);
            struct vec normal = vec_unit(vec_cross(vec(-out.y, out.x, 0), slope));
            mesh_vertex(mesh, frame_point(&at, vec(shift * t + r * out.x, r * out.y, length * t)), frame_dir(&at, normal));
        }
        if (k)
            slices_join(mesh, last, next, sides);
        last = next;
    }
}

void shape_torus(struct mesh *mesh, struct frame at, double radius, double r, double from_deg, double to_deg, int rings, int sides)
{
    struct station stations[65];
    assert(rings <= 64);
    for (int i = 0; i <= rings; i++) {
        double deg = from_deg + (to_deg - from_deg) * i / rings;
        stations[i].centre = frame_point(&at, vec_polar(radius, deg, 0));
        stations[i].tangent = frame_dir(&at, vec_polar(1, deg + 90.0, 0));
    }
    shape_sweep(mesh, stations, rings + 1, r, sides);
}

void shape_block(struct mesh *mesh, struct frame at, double x0, double x1, double y0, double y1, double z0, double z1)
{
    struct vec p[8];
    for (int i = 0; i < 8; i++)
        p[i] = frame_point(&at, vec(i & 1 ? x1 : x0, i & 2 ? y1 : y0, i & 4 ? z1 : z0));
    mesh_quad(mesh, p[0], p[2], p[3], p[1]);
    mesh_quad(mesh, p[4], p[5], p[7], p[6]);
    mesh_quad(mesh, p[0], p[1], p[5], p[4]);
    mesh_quad(mesh, p[2], p[6], p[7], p[3]);
    mesh_quad(mesh, p[0], p[4], p[6], p[2]);
    mesh_quad(mesh, p[1], p[3], p[7], p[5]);
}

/* One face of a sector: a strip between two arcs (r0, z0) and (r1, z1), with the normal n in (radial, axial). */
static void sector_face(struct mesh *mesh, const struct frame *at, double r0, double z0, double r1, double z1, struct vec n,
                        double from_deg,
                        double to_deg, int pieces)
{
    uint32_t first = (uint32_t)mesh->vertex_count;
    for (int i = 0; i <= pieces; i++) {
        double deg = from_deg + (to_deg - from_deg) * i / pieces;
        struct vec normal = frame_dir(at, vec_polar(n.x, deg, n.z));
        mesh_vertex(mesh, frame_point(at, vec_polar(r0, deg, z0)), normal);
        mesh_vertex(mesh, frame_point(at, vec_polar(r1, deg, z1)), normal);
    }
    for (uint32_t i = 0; i < (uint32_t)pieces; i++) {
        uint32_t a = first + 2 * i;
        mesh_triangle(mesh, a, a + 2, a + 3);
        mesh_triangle(mesh, a, a + 3, a + 1);
    }
}

void shape_sector(struct mesh *mesh, struct frame at, double r0, double r1, double z0, double z1, double from_deg, double to_deg,
                  int pieces)
{
    sector_face(mesh, &at, r1, z0, r1, z1, vec(1, 0, 0), from_deg, to_deg, pieces);
    sector_face(mesh, &at, r0, z1, r0, z0, vec(-1, 0, 0), from_deg, to_deg, pieces);
    sector_face(mesh, &at, r1, z1, r0, z1, vec(0, 0, 1), from_deg, to_deg, pieces);
    sector_face(mesh, &at, r0, z0, r1, z0, vec(0, 0, -1), from_deg, to_deg, pieces);
    if (to_deg - from_deg > 359.99)
        return;
    struct frame end = frame_turned(at, from_deg);
    mesh_quad(mesh, frame_point(&end, vec(r0, 0, z0)), frame_point(&end, vec(r1, 0, z0)), frame_point(&end, vec(r1, 0, z1)),
              frame_point(&end, vec(r0, 0, z1)));
    end = frame_turned(at, to_deg);
    mesh_quad(mesh, frame_point(&end, vec(r0, 0, z0)), frame_point(&end, vec(r0, 0, z1)), frame_point(&end, vec(r1, 0, z1)),
              frame_point(&end, vec(r1, 0, z0)));
}

void shape_band(struct mesh *mesh, struct frame at, double r, double width, int sides)
{
    shape_tube(mesh, frame_moved(at, 0, 0, -width / 2), r - 0.006, r + 0.010, width, sides, 0);
}

void shape_bar(struct mesh *mesh, struct vec a, struct vec b, double r, int sides)
{
    struct vec dir = vec_sub(b, a);
    shape_tube(mesh, frame_facing(a, dir, vec(0, 0, 1)), r, r, vec_length(dir), sides, 0);
}

void shape_prism(struct mesh *mesh, struct frame at, const double (*outline)[2], int count, double z0, double z1)
{
    for (int i = 0; i < count; i++) {
        const double *a = outline[i], *b = outline[(i + 1) % count];
        mesh_quad(mesh, frame_point(&at, vec(a[0], a[1], z0)), frame_point(&at, vec(b[0], b[1], z0)), frame_point(&at, vec(b[0], b[1], z1)),
                  frame_point(&at, vec(a[0], a[1], z1)));
    }
    for (int top = 0; top < 2; top++) {
        uint32_t first = (uint32_t)mesh->vertex_count;
        for (int i = 0; i < count; i++)
            mesh_vertex(mesh, frame_point(&at, vec(outline[i][0], outline[i][1], top ? z1 : z0)), vec_scale(at.z, top ? 1.0 : -1.0));
        for (uint32_t i = 1; i + 1 < (uint32_t)count; i++)
            mesh_triangle(mesh, first, first + (top ? i : i + 1), first + (top ? i + 1 : i));
    }
}

void shape_hexagon(struct mesh *mesh, struct frame at, double r, double z0, double z1)
{
    double outline[6][2];
    for (int i = 0; i < 6; i++) {
        outline[i][0] = r * cos(RADIANS(60.0 * i));
        outline[i][1] = r * sin(RADIANS(60.0 * i));
    }
    shape_prism(mesh, at, (const double(*)[2])outline, 6, z0, z1);
}

void shape_sweep(struct mesh *mesh, const struct station *stations, int count, double r, int sides)
{
    struct frame at = frame_facing(stations[0].centre, stations[0].tangent, vec(0, 0, 1));
    struct slice last = { 0, false };
    for (int i = 0; i < count; i++) {
        at = frame_facing(stations[i].centre, stations[i].tangent, at.x); /* carries x along with the least twist */
        struct slice next = slice_add(mesh, &at, r, 0, vec(1, 0, 0), sides);
        if (i)
            slices_join(mesh, last, next, sides);
        last = next;
    }
}
