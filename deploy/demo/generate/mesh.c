/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Growing a mesh, and finding the nearest point of one. */
#include "mesh.h"

#include "base/mem.h"

void mesh_finish(struct mesh *mesh)
{
    mem_free(mesh->vertices);
    mem_free(mesh->indices);
    *mesh = (struct mesh){ 0 };
}

uint32_t mesh_vertex(struct mesh *mesh, struct vec position, struct vec normal)
{
    mem_grow(&mesh->vertices, &mesh->vertex_capacity, mesh->vertex_count + 1, sizeof(*mesh->vertices));
    mesh->vertices[mesh->vertex_count] = (struct mesh_vertex){ { (float)position.x, (float)position.y, (float)position.z },
                                                               { (float)normal.x, (float)normal.y, (float)normal.z } };
    return (uint32_t)mesh->vertex_count++;
}

void mesh_triangle(struct mesh *mesh, uint32_t a, uint32_t b, uint32_t c)
{
    mem_grow(&mesh->indices, &mesh->index_capacity, mesh->index_count + 3, sizeof(*mesh->indices));
    mesh->indices[mesh->index_count++] = a;
    mesh->indices[mesh->index_count++] = b;
    mesh->indices[mesh->index_count++] = c;
}

void mesh_quad(struct mesh *mesh, struct vec a, struct vec b, struct vec c, struct vec d)
{
    struct vec normal = vec_unit(vec_cross(vec_sub(c, a), vec_sub(d, b)));
    uint32_t first = mesh_vertex(mesh, a, normal);
    mesh_vertex(mesh, b, normal);
    mesh_vertex(mesh, c, normal);
    mesh_vertex(mesh, d, normal);
    mesh_triangle(mesh, first, first + 1, first + 2);
    mesh_triangle(mesh, first, first + 2, first + 3);
}

struct vec mesh_position(const struct mesh *mesh, size_t vertex)
{
    const float *p = mesh->vertices[vertex].position;
    return vec((double)p[0], (double)p[1], (double)p[2]);
}

/* Nearest point of a triangle by its Voronoi regions (Ericson, Real-Time Collision Detection, 5.1.5). */
static struct vec triangle_nearest(struct vec p, struct vec a, struct vec b, struct vec c)
{
    struct vec ab = vec_sub(b, a), ac = vec_sub(c, a), ap = vec_sub(p, a), bp = vec_sub(p, b), cp = vec_sub(p, c);
    double d1 = vec_dot(ab, ap), d2 = vec_dot(ac, ap), d3 = vec_dot(ab, bp);
    double d4 = vec_dot(ac, bp), d5 = vec_dot(ab, cp), d6 = vec_dot(ac, cp);
    double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    if (d1 <= 0.0 && d2 <= 0.0)
        return a;
    if (d3 >= 0.0 && d4 <= d3)
        return b;
    if (d6 >= 0.0 && d5 <= d6)
        return c;
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0)
        return vec_along(a, ab, d1 / (d1 - d3));
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0)
        return vec_along(a, ac, d2 / (d2 - d6));
    if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0)
        return vec_along(b, vec_sub(c, b), (d4 - d3) / ((d4 - d3) + (d5 - d6)));
    return vec_add(a, vec_add(vec_scale(ab, vb / (va + vb + vc)), vec_scale(ac, vc / (va + vb + vc))));
}

bool mesh_nearest(const struct mesh *mesh, struct vec point, struct vec *surface, struct vec *normal)
{
    double best = INFINITY;
    for (size_t i = 0; i + 2 < mesh->index_count; i += 3) {
        const uint32_t *corner = mesh->indices + i;
        struct vec a = mesh_position(mesh, corner[0]), b = mesh_position(mesh, corner[1]), c = mesh_position(mesh, corner[2]);
        struct vec q = triangle_nearest(point, a, b, c), d = vec_sub(q, point);
        if (vec_dot(d, d) < best) {
            best = vec_dot(d, d);
            *surface = q;
            *normal = vec_unit(vec_cross(vec_sub(b, a), vec_sub(c, a)));
        }
    }
    return isfinite(best);
}
