/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds the coloured shapes of an asset's debug view: its surface, distances, sample points, and the bridges over its gaps. */
#include "preprocess/debug/debug_view.h"

#include <math.h>
#include <string.h>

#include "base/math/extent.h"
#include "base/mem.h"
#include "base/math/vec.h"
#include "plant/colormaps.h"
#include "preprocess/debug/glb_writer.h"
#include "surface/repair/repair.h"
#include "surface/mesh/trimesh.h"

#define ISOLINES 20 /* maximum number of isolines in a debug view */
/* offset of isolines and open edges above and below the surface, so that the surface does not hide them; relative to the asset's size */
#define LIFT 3e-4
/* size of the cross that marks a bridge (connection over a gap), as a multiple of the spacing of the surface points */
#define MARK 0.3
#define SENSOR 0.012 /* size of a sensor's mark, relative to the asset's size */
#define DARKEST 0.75 /* brightness of faces seen edge-on */
static const double light[3] = { 0.36, -0.48, 0.8 };

static const uint8_t plain_color[3] = { 150, 155, 160 }, unreached_color[3] = { 235, 0, 235 }, hidden_color[3] = { 255, 140, 0 },
                     bridge_color[3] = { 255, 30, 30 }, edge_color[3] = { 255, 255, 255 }, line_color[3] = { 0, 0, 0 },
                     model_color[3] = { 240, 240, 240 }, sample_color[3] = { 120, 120, 120 }, sensor_color[3] = { 255, 0, 0 },
                     other_color[3] = { 60, 60, 60 };

struct debug_drawing {
    const struct debug_view *view;
    struct surface_debug_mesh look;
    struct glb_writer *writer;
    double size_m, spacing_m, farthest_m;
};

struct soup { /* a shape being built */
    float (*positions)[3];
    uint16_t (*colors)[4];
    /* vertex_of: by surface point: 1 + index of its vertex in this shape; 0: no vertex yet */
    uint32_t *indices, *vertex_of;
    size_t vertices, indices_used, position_room, color_room, index_room;
};

/* Adds a vertex to the triangles of a GLB file, converting it from Z up to Y up. Returns its index. */
static uint32_t add_vertex(struct soup *soup, const double p[3])
{
    mem_grow(&soup->positions, &soup->position_room, soup->vertices + 1, sizeof(*soup->positions));
    float *at = soup->positions[soup->vertices];
    at[0] = (float)p[0];
    at[1] = (float)p[2];
    at[2] = (float)-p[1];
    return (uint32_t)soup->vertices++;
}

static void add_line(struct soup *soup, const double a[3], const double b[3])
{
    add_vertex(soup, a);
    add_vertex(soup, b);
}

static void give(struct debug_drawing *drawing, struct soup *soup, const char *name, enum glb_mode mode, const uint8_t color[3])
{
    struct glb_shape shape = { .mode = mode,
                               .positions = (const float(*)[3])soup->positions,
                               .colors = (const uint16_t(*)[4])soup->colors,
                               .indices = soup->indices,
                               .vertex_count = soup->vertices,
                               .index_count = soup->indices_used };
    if (color)
        memcpy(shape.color, color, sizeof(shape.color));
    glb_writer_add(drawing->writer, name, &shape);
    mem_free(soup->positions);
    mem_free(soup->colors);
    mem_free(soup->indices);
    mem_free(soup->vertex_of);
    *soup = (struct soup){ 0 };
}

/* --- surfaces ---------------------------------------------------------------------------------------------------------------- */

static void face_normal(const struct surface_debug_mesh *look, size_t t, double n[3])
{
    const uint32_t *v = look->tris[t];
    vec_normal(look->points_m[v[0]], look->points_m[v[1]], look->points_m[v[2]], n);
}

/* Computes a normal at each surface point from the surrounding triangles, whose orientation may be inconsistent. */
static double (*find_normals(const struct surface_debug_mesh *look))[3]
{
    double(*normals)[3] = mem_array(look->point_count, sizeof(*normals));
    for (size_t t = 0; t < look->tri_count; t++) {
        double n[3];
        face_normal(look, t, n);
        for (int i = 0; i < 3; i++) {
            double *at = normals[look->tris[t][i]], sign = vec_dot(at, n) < 0 ? -1 : 1;
            for (int axis = 0; axis < 3; axis++)
                at[axis] += sign * n[axis];
        }
    }
    return normals;
}

static void color_at(const struct debug_drawing *drawing, uint32_t point, const uint8_t plain[3], const double normal[3], uint16_t out[4])
{
    double length = vec_length(normal), shade = length > 0 ? DARKEST + (1 - DARKEST) * fabs(vec_dot(normal, light)) / length : 1;
    const uint8_t *rgb = plain;
    if (!plain) {
        double share = drawing->farthest_m > 0 ? (double)drawing->view->distances_m[point] / drawing->farthest_m : 0;
        rgb = colormap_at(NULL, (size_t)colormap_find(NULL, "viridis"))->rgb[(int)min_of(max_of(255 * share, 0), 255)];
    }
    for (int i = 0; i < 3; i++)
        out[i] = (uint16_t)(shade * glb_linear(rgb[i]));
    out[3] = 65535;
}

static void add_triangle(struct debug_drawing *drawing, struct soup *soup, size_t t, const uint8_t plain[3], const double (*normals)[3])
{
    mem_grow(&soup->indices, &soup->index_room, soup->indices_used + 3, sizeof(*soup->indices));
    if (!soup->vertex_of)
        soup->vertex_of = mem_array(drawing->look.point_count, sizeof(*soup->vertex_of));
    for (int i = 0; i < 3; i++) {
        uint32_t point = drawing->look.tris[t][i], *vertex = &soup->vertex_of[point];
        if (!*vertex) {
            *vertex = 1 + add_vertex(soup, drawing->look.points_m[point]);
            mem_grow(&soup->colors, &soup->color_room, soup->vertices, sizeof(*soup->colors));
            color_at(drawing, point, plain, normals[point], soup->colors[*vertex - 1]);
        }
        soup->indices[soup->indices_used++] = *vertex - 1;
    }
}

static bool is_reached(const struct debug_drawing *drawing, size_t t)
{
    for (int i = 0; i < 3; i++)
        if (!isfinite(drawing->view->distances_m[drawing->look.tris[t][i]]))
            return false;
    return true;
}

static void draw_surfaces(struct debug_drawing *drawing)
{
    struct soup reached = { 0 }, unreached = { 0 }, hidden = { 0 };
    double(*normals)[3] = find_normals(&drawing->look);
    const double(*const_normals)[3] = (const double(*)[3])normals;
    for (size_t t = 0; t < drawing->look.tri_count; t++) {
        if (t >= drawing->look.visible_count)
            add_triangle(drawing, &hidden, t, hidden_color, const_normals);
        else if (!drawing->view->distances_m)
            add_triangle(drawing, &reached, t, plain_color, const_normals);
        else if (is_reached(drawing, t))
            add_triangle(drawing, &reached, t, NULL, const_normals);
        else
            add_triangle(drawing, &unreached, t, unreached_color, const_normals);
    }
    char *name = drawing->view->distances_m ? mem_printf("distance from %s, 0 to %.4g m", drawing->view->sensor, drawing->farthest_m)
                                            : mem_strdup("surface");
    give(drawing, &reached, name, GLB_TRIANGLES, NULL);
    give(drawing, &unreached, "unreachable", GLB_TRIANGLES, NULL);
    give(drawing, &hidden, "hidden inside another part", GLB_TRIANGLES, NULL);
    mem_free(normals);
    mem_free(name);
}

/* --- lines on surfaces --------------------------------------------------------------------------------------------------------- */

/* Draws a line twice, slightly above each side of the surface, because the surface would hide a single line from one side. */
static void add_lifted(struct soup *soup, const struct debug_drawing *drawing, size_t t, const double a[3], const double b[3])
{
    double n[3], length;
    face_normal(&drawing->look, t, n);
    length = vec_length(n);
    for (int side = -1; side <= 1 && length > 0; side += 2) {
        double p[3], q[3];
        for (int axis = 0; axis < 3; axis++) {
            double lift_m = side * LIFT * drawing->size_m * n[axis] / length;
            p[axis] = a[axis] + lift_m;
            q[axis] = b[axis] + lift_m;
        }
        add_line(soup, p, q);
    }
}

/* Returns the distance in metres between neighbouring isolines: 1, 2 or 5 times a power of ten. */
static double isoline_step(double range_m)
{
    double least = range_m / ISOLINES, power = pow(10, floor(log10(least)));
    return least <= power ? power : least <= 2 * power ? 2 * power : least <= 5 * power ? 5 * power : 10 * power;
}

static void add_isolines(struct soup *soup, const struct debug_drawing *drawing, size_t t, double step_m)
{
    const uint32_t *v = drawing->look.tris[t];
    double d[3], low = INFINITY, high = -INFINITY;
    for (int i = 0; i < 3; i++) {
        d[i] = (double)drawing->view->distances_m[v[i]];
        low = min_of(low, d[i]);
        high = max_of(high, d[i]);
    }
    for (double at_m = step_m * (floor(low / step_m) + 1); at_m < high; at_m += step_m) {
        double ends[2][3];
        int found = 0;
        for (int i = 0; i < 3 && found < 2; i++) {
            int j = (i + 1) % 3;
            if ((d[i] < at_m) != (d[j] < at_m))
                vec_mix(drawing->look.points_m[v[i]], drawing->look.points_m[v[j]], (at_m - d[i]) / (d[j] - d[i]), ends[found++]);
        }
        if (found == 2)
            add_lifted(soup, drawing, t, ends[0], ends[1]);
    }
}

static void draw_isolines(struct debug_drawing *drawing)
{
    struct soup soup = { 0 };
    if (!drawing->view->distances_m || drawing->farthest_m <= 0)
        return;
    double step_m = isoline_step(drawing->farthest_m);
    for (size_t t = 0; t < drawing->look.visible_count; t++)
        if (is_reached(drawing, t))
            add_isolines(&soup, drawing, t, step_m);
    char *name = mem_printf("isolines, every %g m", step_m);
    give(drawing, &soup, name, GLB_LINES, line_color);
    mem_free(name);
}

static void draw_open_edges(struct debug_drawing *drawing)
{
    const struct surface_debug_mesh *look = &drawing->look;
    struct soup soup = { 0 };
    struct edge_table edges;
    unsigned char *faces = mem_array(3 * look->visible_count, 1);
    edge_table_init(&edges, 3 * look->visible_count / 2);
    for (int pass = 0; pass < 2; pass++)
        for (size_t t = 0; t < look->visible_count; t++)
            for (int i = 0; i < 3; i++) {
                uint32_t a = look->tris[t][i], b = look->tris[t][(i + 1) % 3], e = edge_table_add(&edges, a, b);
                if (pass == 0)
                    faces[e] = (unsigned char)(faces[e] < 2 ? faces[e] + 1 : 2);
                else if (faces[e] == 1)
                    add_lifted(&soup, drawing, t, look->points_m[a], look->points_m[b]);
            }
    give(drawing, &soup, "open edges", GLB_LINES, edge_color);
    edge_table_finish(&edges);
    mem_free(faces);
}

/* --- points, bridges, sensors ---------------------------------------------------------------------------------------------------- */

static void draw_points(struct debug_drawing *drawing)
{
    const struct surface_debug_mesh *look = &drawing->look;
    struct soup model = { 0 }, samples = { 0 };
    /* by surface point: 0: used by no triangle; 1: used by a triangle; 2: also a vertex of the model */
    char *kind = mem_array(look->point_count, 1);
    for (size_t t = 0; t < look->tri_count; t++)
        for (int i = 0; i < 3; i++)
            kind[look->tris[t][i]] = 1;
    for (size_t v = 0; v < look->vertex_count; v++)
        if (kind[look->vertex_point[v]])
            kind[look->vertex_point[v]] = 2;
    for (size_t p = 0; p < look->point_count; p++)
        if (kind[p])
            add_vertex(kind[p] == 2 ? &model : &samples, look->points_m[p]);
    give(drawing, &model, "points of the model", GLB_POINTS, model_color);
    give(drawing, &samples, "points added", GLB_POINTS, sample_color);
    mem_free(kind);
}

static void draw_bridges(struct debug_drawing *drawing)
{
    struct soup lines = { 0 }, marks = { 0 };
    for (size_t i = 0; i < drawing->look.bridge_count; i++) {
        const struct crack_bridge *bridge = &drawing->look.bridges[i];
        double middle[3];
        add_line(&lines, bridge->from_m, bridge->to_m);
        vec_mix(bridge->from_m, bridge->to_m, 0.5, middle);
        for (int axis = 0; axis < 3; axis++) {
            double a[3] = { middle[0], middle[1], middle[2] }, b[3] = { middle[0], middle[1], middle[2] };
            a[axis] -= MARK * drawing->spacing_m;
            b[axis] += MARK * drawing->spacing_m;
            add_line(&marks, a, b);
        }
    }
    give(drawing, &lines, "bridges", GLB_LINES, bridge_color);
    give(drawing, &marks, "where the bridges are", GLB_LINES, bridge_color);
}

static void add_octahedron(struct soup *soup, const double middle[3], double radius_m)
{
    for (int face = 0; face < 8; face++) {
        bool turned = ((face & 1) + (face >> 1 & 1) + (face >> 2)) % 2 != 0;
        for (int i = 0; i < 3; i++) {
            int axis = turned ? i : 2 - i;
            double p[3] = { middle[0], middle[1], middle[2] };
            p[axis] += face >> axis & 1 ? radius_m : -radius_m;
            add_vertex(soup, p);
        }
    }
}

static void draw_sensors(struct debug_drawing *drawing)
{
    const struct debug_view *view = drawing->view;
    struct soup chosen = { 0 }, others = { 0 }, ways = { 0 };
    for (size_t i = 0; i < view->sensor_count; i++) {
        struct surface_place at;
        bool is_chosen = i == view->chosen && view->distances_m;
        surface_nearest(view->surface, view->sensors_m[i], &at);
        add_octahedron(is_chosen ? &chosen : &others, view->sensors_m[i], SENSOR * drawing->size_m * (is_chosen ? 1 : 0.6));
        add_line(&ways, view->sensors_m[i], at.position_m);
    }
    char *name = mem_printf("sensor %s", view->sensor);
    give(drawing, &chosen, name, GLB_TRIANGLES, sensor_color);
    give(drawing, &others, "other sensors", GLB_TRIANGLES, other_color);
    give(drawing, &ways, "sensors to the surface", GLB_LINES, sensor_color);
    mem_free(name);
}

static void measure(struct debug_drawing *drawing)
{
    struct extent extent = extent_empty();
    for (size_t t = 0; t < drawing->look.tri_count; t++)
        for (int i = 0; i < 3; i++) {
            uint32_t p = drawing->look.tris[t][i];
            extent_add(&extent, drawing->look.points_m[p]);
            double d = drawing->view->distances_m && t < drawing->look.visible_count ? (double)drawing->view->distances_m[p] : 0;
            drawing->farthest_m = isfinite(d) ? max_of(drawing->farthest_m, d) : drawing->farthest_m;
        }
    drawing->size_m = extent_size(&extent);
    drawing->spacing_m = surface_report(drawing->view->surface)->spacing_m;
}

int debug_view_save(const struct debug_view *view, const char *path)
{
    struct debug_drawing drawing = { .view = view, .writer = glb_writer_create(view->name) };
    surface_debug_mesh(view->surface, &drawing.look);
    measure(&drawing);
    draw_surfaces(&drawing);
    draw_isolines(&drawing);
    draw_open_edges(&drawing);
    draw_points(&drawing);
    draw_bridges(&drawing);
    draw_sensors(&drawing);
    int status = glb_writer_save(drawing.writer, path);
    glb_writer_destroy(&drawing.writer);
    return status;
}
