/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds plates, boxes and cylinders. */
#include "tests/support/shape.h"

#include <math.h>
#include <stdbool.h>

#include "base/mem.h"

static uint32_t add_vertex(struct test_shape *shape, const double p[3], const double n[3])
{
    size_t i = shape->vertex_count++;
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    mem_grow(&shape->positions, &shape->position_capacity, i + 1, sizeof(*shape->positions));
    mem_grow(&shape->normals, &shape->normal_capacity, i + 1, sizeof(*shape->normals));
    for (int c = 0; c < 3; c++) {
        shape->positions[i][c] = (float)p[c];
        shape->normals[i][c] = (float)(n[c] / length);
    }
    return (uint32_t)i;
}

static void add_triangle(struct test_shape *shape, uint32_t a, uint32_t b, uint32_t c)
{
    mem_grow(&shape->indices, &shape->index_capacity, shape->index_count + 3, sizeof(*shape->indices));
    shape->indices[shape->index_count++] = a;
    shape->indices[shape->index_count++] = b;
    shape->indices[shape->index_count++] = c;
}

static void begin(struct test_shape *shape, uint32_t material)
{
    mem_grow(&shape->primitives, &shape->primitive_capacity, shape->primitive_count + 1, sizeof(*shape->primitives));
    shape->primitives[shape->primitive_count] =
        (struct asset_primitive){ .first_index = (uint32_t)shape->index_count, .material = material };
}

static void end(struct test_shape *shape)
{
    struct asset_primitive *primitive = &shape->primitives[shape->primitive_count++];
    primitive->index_count = (uint32_t)shape->index_count - primitive->first_index;
}

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Adds the triangles of a grid of columns x rows cells, whose (columns + 1) x (rows + 1) vertices were just added row by row
   from vertex `first` on. */
static void add_grid(struct test_shape *shape, uint32_t first, int columns, int rows)
{
    for (int y = 0; y < rows; y++)
        for (int x = 0; x < columns; x++) {
            uint32_t a = first + (uint32_t)(y * (columns + 1) + x), c = a + (uint32_t)columns + 1;
            add_triangle(shape, a, a + 1, c + 1);
            add_triangle(shape, a, c + 1, c);
        }
}

static void add_plate(struct test_shape *shape, const double corner[3], const double u[3], const double v[3], int n)
{
    double normal[3];
    uint32_t first = (uint32_t)shape->vertex_count;
    cross(u, v, normal);
    for (int y = 0; y <= n; y++)
        for (int x = 0; x <= n; x++) {
            double p[3];
            for (int c = 0; c < 3; c++)
                p[c] = corner[c] + u[c] * x / n + v[c] * y / n;
            add_vertex(shape, p, normal);
        }
    add_grid(shape, first, n, n);
}

void shape_plate(struct test_shape *shape, uint32_t material, const double corner[3], const double u[3], const double v[3], int n)
{
    begin(shape, material);
    add_plate(shape, corner, u, v, n);
    end(shape);
}

void shape_box(struct test_shape *shape, uint32_t material, const double low[3], const double high[3])
{
    double x[3] = { high[0] - low[0], 0, 0 }, y[3] = { 0, high[1] - low[1], 0 }, z[3] = { 0, 0, high[2] - low[2] };
    begin(shape, material);
    for (int axis = 0; axis < 3; axis++) {
        const double *u = axis == 0 ? y : axis == 1 ? z : x, *v = axis == 0 ? z : axis == 1 ? x : y;
        double corner[3] = { low[0], low[1], low[2] };
        add_plate(shape, corner, v, u, 4);
        corner[axis] = high[axis];
        add_plate(shape, corner, u, v, 4);
    }
    end(shape);
}

/* a point of the profile that is rotated about the axis: its position along the axis, its distance from the axis, and the
   normal in these two directions */
struct curve_point {
    double along, out, normal_along, normal_out;
};

static void add_lathe(struct test_shape *shape, const double a[3], const double axis[3], const struct curve_point *profile, int count)
{
    enum { AROUND = 48 };
    bool steep = fabs(axis[2]) >= 0.9;
    double helper[3] = { steep, 0, !steep }, side[3], front[3];
    cross(helper, axis, side);
    double length = sqrt(side[0] * side[0] + side[1] * side[1] + side[2] * side[2]);
    for (int c = 0; c < 3; c++)
        side[c] /= length;
    cross(axis, side, front);
    uint32_t first = (uint32_t)shape->vertex_count;
    for (int i = 0; i < count; i++)
        for (int k = 0; k <= AROUND; k++) {
            double angle = 2 * M_PI * k / AROUND, p[3], n[3];
            for (int c = 0; c < 3; c++) {
                double outward = side[c] * cos(angle) + front[c] * sin(angle);
                p[c] = a[c] + axis[c] * profile[i].along + outward * profile[i].out;
                n[c] = axis[c] * profile[i].normal_along + outward * profile[i].normal_out;
            }
            add_vertex(shape, p, n);
        }
    add_grid(shape, first, AROUND, count - 1);
}

void shape_cylinder(struct test_shape *shape, uint32_t material, const double a[3], const double b[3], double ra, double rb, int round)
{
    enum { CAP = 9, RINGS = 24 };
    struct curve_point side[RINGS + 1], cap[CAP];
    double axis[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
    double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    for (int c = 0; c < 3; c++)
        axis[c] /= length;
    begin(shape, material);
    for (int i = 0; i <= RINGS; i++)
        side[i] = (struct curve_point){ length * i / RINGS, ra + (rb - ra) * i / RINGS, (ra - rb) / length, 1 };
    add_lathe(shape, a, axis, side, RINGS + 1);
    for (int end_cap = 0; end_cap < 2; end_cap++) {
        double at = end_cap ? length : 0, r = end_cap ? rb : ra, sign = end_cap ? 1 : -1;
        for (int i = 0; i < CAP; i++) {
            double angle = 0.5 * M_PI * (end_cap ? i : CAP - 1 - i) / (CAP - 1), out = fmax(cos(angle), 1e-4);
            cap[i] = round ? (struct curve_point){ at + sign * 0.5 * r * sin(angle), r * out, sign * 2 * sin(angle), out }
                           : (struct curve_point){ at, r * out, sign, 0 };
        }
        add_lathe(shape, a, axis, cap, CAP);
    }
    end(shape);
}

void shape_sphere(struct test_shape *shape, uint32_t material, const double middle[3], double radius, int n)
{
    uint32_t first = (uint32_t)shape->vertex_count;
    begin(shape, material);
    for (int y = 0; y <= n; y++)
        for (int x = 0; x <= 2 * n; x++) {
            double up = M_PI * (y - 0.5 * n) / n, turn = M_PI * x / n;
            double normal[3] = { cos(up) * cos(turn), cos(up) * sin(turn), sin(up) }, p[3];
            for (int c = 0; c < 3; c++)
                p[c] = middle[c] + radius * normal[c];
            add_vertex(shape, p, normal);
        }
    add_grid(shape, first, 2 * n, n);
    end(shape);
}

void shape_finish(struct test_shape *shape)
{
    mem_free(shape->positions);
    mem_free(shape->normals);
    mem_free(shape->indices);
    mem_free(shape->primitives);
    *shape = (struct test_shape){ 0 };
}
