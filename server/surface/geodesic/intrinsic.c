/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds the intrinsic Delaunay triangulation (intrinsic.h). Connects triangles to patches across edges with two faces. Flips
   these edges, where possible, until the triangulation is Delaunay. */
#include "surface/geodesic/intrinsic.h"

#include <math.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "surface/mesh/tri_edges.h"

#define MOLLIFY 1e-5
#define FLIPS_PER_EDGE 50u /* maximum number of flips per edge; without a limit, rounding errors might repeat flips forever */

void intrinsic_finish(struct intrinsic *in)
{
    mem_free(in->points);
    mem_free(in->lengths);
    mem_free(in->glue);
    *in = (struct intrinsic){ 0 };
}

/* Gives all triangles of each patch (connected by edges with two faces) the same orientation. facing[triangle]: receives -1 if it was
   reversed, else 1. */
static void orient(struct intrinsic *in, const struct tri_edges *edges, signed char *facing)
{
    tri_edges_orient_all(edges, facing);
    for (size_t t = 0; t < in->tri_count; t++) {
        uint32_t *tri = in->points[t], swap = tri[1];
        if (facing[t] < 0) {
            tri[1] = tri[2];
            tri[2] = swap;
        }
    }
}

/* Returns the new index of a side after its triangle was reoriented (facing < 0), which exchanges sides 0 and 2. */
static uint32_t turned_side(uint32_t side, const signed char *facing)
{
    return facing[side / 3] < 0 ? side - side % 3 + 2 - side % 3 : side;
}

/* Records in in->glue, for each edge with two faces, that its two sides are adjacent, if they run in opposite directions. Sides that run in
   the same direction, as on a Moebius strip, are not recorded, so their edge is never flipped. */
static void glue_sides(struct intrinsic *in, const struct tri_edges *edges, const signed char *facing)
{
    for (uint32_t side = 0; side < 3 * in->tri_count; side++) {
        uint32_t other = tri_edges_across(edges, side), at = turned_side(side, facing);
        bool glued = other != TRIMESH_NONE && tri_edges_run_alike(edges, side, other) == (facing[side / 3] != facing[other / 3]);
        in->glue[at / 3][at % 3] = glued ? turned_side(other, facing) : TRIMESH_NONE;
    }
}

void intrinsic_layout(const double lengths[3], double *x, double *y)
{
    double a = lengths[0], b = lengths[1], c = lengths[2]; /* corners 0-1, 1-2, 2-0 */
    *x = (a * a + c * c - b * b) / (2 * a);
    *y = sqrt(max_of(c * c - *x * *x, 0));
}

static double cotangent_opposite(const double lengths[3], int side)
{
    double a = lengths[side], b = lengths[(side + 1) % 3], c = lengths[(side + 2) % 3], s = (a + b + c) / 2;
    double area2 = 4 * s * (s - a) * (s - b) * (s - c); /* (2 area)^2 */
    return (b * b + c * c - a * a) / (2 * sqrt(max_of(area2, 1e-300)));
}

/* Flips the edge between two triangles of one patch (triangles connected by edges with two faces). Returns false if that is impossible:
 * both sides belong to one triangle, or the quadrilateral is not convex. */
static bool flip(struct intrinsic *in, uint32_t t, int i)
{
    uint32_t u = in->glue[t][i] / 3;
    int j = (int)(in->glue[t][i] % 3);
    if (u == t)
        return false;
    /* notation: triangle t has the corners p, q, r and shares its side pq with triangle u, which has the corners q, p, s */
    const double *lt = in->lengths[t], *lu = in->lengths[u];
    double pq = lt[i], qr = lt[(i + 1) % 3], rp = lt[(i + 2) % 3], ps = lu[(j + 1) % 3], sq = lu[(j + 2) % 3];
    double rx = (pq * pq + rp * rp - qr * qr) / (2 * pq), ry = sqrt(max_of(rp * rp - rx * rx, 0));
    double sx = (pq * pq + ps * ps - sq * sq) / (2 * pq), sy = -sqrt(max_of(ps * ps - sx * sx, 0));
    /* distance from p, along edge pq, of the crossing with the edge rs that is to replace pq; -1: they do not cross */
    double cut = ry - sy > 0 ? rx + (sx - rx) * ry / (ry - sy) : -1;
    if (cut <= 0 || cut >= pq)
        return false;
    double rs = hypot(rx - sx, ry - sy);
    uint32_t p = in->points[t][i], q = in->points[t][(i + 1) % 3], r = in->points[t][(i + 2) % 3], s = in->points[u][(j + 2) % 3];
    uint32_t g_qr = in->glue[t][(i + 1) % 3], g_rp = in->glue[t][(i + 2) % 3], g_ps = in->glue[u][(j + 1) % 3],
             g_sq = in->glue[u][(j + 2) % 3];
    memcpy(in->points[t], (const uint32_t[3]){ s, r, p }, sizeof(in->points[t]));
    memcpy(in->points[u], (const uint32_t[3]){ r, s, q }, sizeof(in->points[u]));
    memcpy(in->lengths[t], (const double[3]){ rs, rp, ps }, sizeof(in->lengths[t]));
    memcpy(in->lengths[u], (const double[3]){ rs, sq, qr }, sizeof(in->lengths[u]));
    /* The flip renumbers the four outer sides of the two triangles. If two of these outer sides are glued to each other (marked
       as adjacent), the reference from one to the other must get the new index. */
    uint32_t outer[4] = { g_rp, g_ps, g_sq, g_qr };
    const uint32_t was[4] = { 3 * t + (uint32_t)((i + 2) % 3), 3 * u + (uint32_t)((j + 1) % 3), 3 * u + (uint32_t)((j + 2) % 3),
                              3 * t + (uint32_t)((i + 1) % 3) };
    const uint32_t is[4] = { 3 * t + 1, 3 * t + 2, 3 * u + 1, 3 * u + 2 };
    for (int k = 0; k < 4; k++)
        for (int m = 0; m < 4; m++)
            if (outer[k] == was[m]) {
                outer[k] = is[m];
                break;
            }
    for (int k = 0; k < 4; k++) {
        in->glue[is[k] / 3][is[k] % 3] = outer[k];
        if (outer[k] != TRIMESH_NONE)
            in->glue[outer[k] / 3][outer[k] % 3] = is[k];
    }
    in->glue[t][0] = 3 * u;
    in->glue[u][0] = 3 * t;
    in->flips++;
    return true;
}

/* Lengthens all sides of all triangles by the same small amount. In each triangle, two sides together then exceed the third by
 * at least MOLLIFY mean edge lengths. So no triangle is flat, and its cotangents are finite (Sharp & Crane 2020, section 4.5).
 * */
static void mollify(struct intrinsic *in)
{
    double sum = 0, lack = 0;
    for (size_t t = 0; t < in->tri_count; t++)
        sum += in->lengths[t][0] + in->lengths[t][1] + in->lengths[t][2];
    double margin = MOLLIFY * sum / (3.0 * (double)in->tri_count);
    for (size_t t = 0; t < in->tri_count; t++)
        for (int i = 0; i < 3; i++)
            lack = max_of(lack, margin + in->lengths[t][i] - in->lengths[t][(i + 1) % 3] - in->lengths[t][(i + 2) % 3]);
    for (size_t t = 0; t < in->tri_count; t++)
        for (int i = 0; i < 3; i++)
            in->lengths[t][i] += lack;
    in->lengthened_m = lack;
}

static void push(uint32_t **stack, size_t *depth, size_t *capacity, uint32_t side)
{
    mem_grow(stack, capacity, *depth + 1, sizeof(**stack));
    (*stack)[(*depth)++] = side;
}

static void make_delaunay(struct intrinsic *in)
{
    uint32_t *stack = NULL;
    size_t depth = 0, capacity = 0, limit = in->tri_count * FLIPS_PER_EDGE;
    for (uint32_t side = 0; side < 3 * in->tri_count; side++)
        if (in->glue[side / 3][side % 3] != TRIMESH_NONE)
            push(&stack, &depth, &capacity, side);
    while (depth && in->flips < limit) {
        uint32_t side = stack[--depth], t = side / 3, other = in->glue[t][side % 3];
        if (other == TRIMESH_NONE)
            continue;
        uint32_t u = other / 3;
        double weight = cotangent_opposite(in->lengths[t], (int)(side % 3)) + cotangent_opposite(in->lengths[u], (int)(other % 3));
        if (weight >= -1e-9 || !flip(in, t, (int)(side % 3)))
            continue;
        for (uint32_t i = 1; i < 3; i++) {
            push(&stack, &depth, &capacity, 3 * t + i);
            push(&stack, &depth, &capacity, 3 * u + i);
        }
    }
    mem_free(stack);
}

void intrinsic_init(struct intrinsic *in, const struct trimesh *mesh)
{
    *in = (struct intrinsic){ .tri_count = mesh->tri_count, .point_count = mesh->point_count };
    in->points = mem_array(mesh->tri_count, sizeof(*in->points));
    in->lengths = mem_array(mesh->tri_count, sizeof(*in->lengths));
    in->glue = mem_array(mesh->tri_count, sizeof(*in->glue));
    struct tri_edges edges;
    signed char *facing = mem_array(mesh->tri_count, 1);
    memcpy(in->points, mesh->tris, mesh->tri_count * sizeof(*in->points));
    tri_edges_init(&edges, (const uint32_t(*)[3])mesh->tris, mesh->tri_count);
    orient(in, &edges, facing);
    glue_sides(in, &edges, facing);
    tri_edges_finish(&edges);
    mem_free(facing);
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++)
            in->lengths[t][i] = vec_distance(mesh->points[in->points[t][i]], mesh->points[in->points[t][(i + 1) % 3]]);
    mollify(in);
    make_delaunay(in);
}
