/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Spoiling good meshes, the same way each time. */
#include "faults.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

struct patch {
    const char *node;
    double x, y, z, r;   /* a ball in the asset's own frame */
    double shrink_m;     /* 0: unwelded only */
};

static const struct patch patches[] = {
    { "E-101 shell", 0.3, -0.5, 1.6, 0.45, 0.0004 },
    { "E-101 shell", -1.2, 0.5, 1.4, 0.40, 0.0010 },
    { "E-101 heads", 3.0, 0.0, 1.6, 0.50, 0.0 },
    { "E-102 shell", 0.2, -0.8, 1.6, 0.60, 0.0008 },
    { "T-101 shell", 0.0, -0.85, 9.0, 0.90, 0.0010 },
    { "T-101 shell", 0.0, 0.85, 14.0, 0.90, 0.0 },
    { "V-101 shell", 0.5, -0.8, 5.0, 0.60, 0.0002 },
    { "TK-101 shell", 0.0, -2.9, 4.0, 1.40, 0.0006 },
};

static const struct {
    const char *node;
    int stride;          /* every so many triangles: one repeated, one sliver, and on the underside one flipped */
} spoiled[] = { { "E-101 shell", 1500 }, { "E-102 shell", 500 }, { "T-101 shell", 700 }, { "V-101 shell", 600 }, { "TK-101 shell", 400 } };

static struct mesh *mesh_of(struct model *model, const char *node_name)
{
    int node = model_find_node(model, node_name);
    return node < 0 ? NULL : &model->meshes[model->nodes[node].mesh]->mesh;
}

static bool in_patch(const struct mesh *mesh, const uint32_t *corner, const struct patch *patch)
{
    for (int k = 0; k < 3; k++)
        if (vec_length(vec_sub(mesh_position(mesh, corner[k]), vec(patch->x, patch->y, patch->z))) > patch->r)
            return false;
    return true;
}

static uint32_t doubled_vertex(struct mesh *mesh, uint32_t *copies, uint32_t vertex, const struct patch *patch)
{
    if (copies[vertex])
        return copies[vertex];
    struct vec p = mesh_position(mesh, vertex), inward = vec_unit(vec_sub(vec(patch->x, patch->y, patch->z), p));
    const float *n = mesh->vertices[vertex].normal;
    struct vec normal = vec((double)n[0], (double)n[1], (double)n[2]);
    inward = vec_unit(vec_sub(inward, vec_scale(normal, vec_dot(inward, normal)))); /* along the surface */
    copies[vertex] = mesh_vertex(mesh, vec_along(p, inward, patch->shrink_m), normal);
    return copies[vertex];
}

static void cut_patch(struct mesh *mesh, const struct patch *patch)
{
    uint32_t *copies = mem_array(mesh->vertex_count, sizeof(*copies)); /* 0: none yet; vertex 0 itself is never a copy */
    for (size_t i = 0; i < mesh->index_count; i += 3) {
        if (!in_patch(mesh, mesh->indices + i, patch))
            continue;
        for (int k = 0; k < 3; k++)
            mesh->indices[i + (size_t)k] = doubled_vertex(mesh, copies, mesh->indices[i + (size_t)k], patch);
    }
    mem_free(copies);
}

static struct vec vertex_normal(const struct mesh *mesh, uint32_t vertex)
{
    const float *n = mesh->vertices[vertex].normal;
    return vec((double)n[0], (double)n[1], (double)n[2]);
}

/* Replaces a triangle by three that meet 0.1 mm from the middle of its first edge: one of them is a sliver. */
static void cut_sliver(struct mesh *mesh, size_t triangle)
{
    uint32_t a = mesh->indices[triangle], b = mesh->indices[triangle + 1], c = mesh->indices[triangle + 2];
    struct vec middle = vec_lerp(mesh_position(mesh, a), mesh_position(mesh, b), 0.5);
    struct vec to_c = vec_unit(vec_sub(mesh_position(mesh, c), middle));
    uint32_t m = mesh_vertex(mesh, vec_along(middle, to_c, 0.0001), vec_unit(vec_add(vertex_normal(mesh, a), vertex_normal(mesh, b))));
    mesh->indices[triangle + 2] = m;
    mesh_triangle(mesh, b, c, m);
    mesh_triangle(mesh, c, a, m);
}

static void spoil(struct mesh *mesh, int stride)
{
    size_t count = mesh->index_count;
    for (size_t i = 0; i + 2 < count; i += 3 * (size_t)stride) {
        mesh_triangle(mesh, mesh->indices[i], mesh->indices[i + 1], mesh->indices[i + 2]);
        size_t sliver = i + 3 * (size_t)(stride / 3);
        if (sliver + 2 < count)
            cut_sliver(mesh, sliver);
        for (size_t k = i + 3 * (size_t)(stride / 2); k + 2 < count && k < i + 3 * (size_t)stride; k += 3) {
            if (mesh->vertices[mesh->indices[k]].normal[2] > -0.9f)
                continue;
            uint32_t swap = mesh->indices[k + 1];
            mesh->indices[k + 1] = mesh->indices[k + 2];
            mesh->indices[k + 2] = swap;
            break;
        }
    }
}

void faults_apply(struct model *model)
{
    for (size_t i = 0; i < sizeof(patches) / sizeof(patches[0]); i++)
        cut_patch(mesh_of(model, patches[i].node), patches + i);
    for (size_t i = 0; i < sizeof(spoiled) / sizeof(spoiled[0]); i++)
        spoil(mesh_of(model, spoiled[i].node), spoiled[i].stride);
}
