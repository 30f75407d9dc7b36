/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decides for two kinds of triangles whether they are hidden: small visible groups among hidden triangles (interior_islands),
   and triangles that stand across a thin part (interior_resolve_across). */

#include "base/mem.h"
#include "surface/repair/interior.h"

struct island {                /* island: group of visible triangles connected by points; groups are indexed by their lowest point */
    /* seen_m2: area of the group in square metres; hidden_m2: area of the hidden triangles that touch the group */
    double seen_m2, hidden_m2;
    bool free;                 /* true: some point of the group touches no hidden triangle, so the group stays visible */
};

void interior_islands(const struct trimesh *mesh, char *hidden)
{
    uint32_t *root = mem_array(mesh->point_count, sizeof(*root));
    char *touched = mem_array(mesh->point_count, 1);
    struct island *islands = mem_array(mesh->point_count, sizeof(*islands));
    for (uint32_t i = 0; i < mesh->point_count; i++)
        root[i] = i;
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 1; i < 3 && !hidden[t]; i++)
            trimesh_join(root, mesh->tris[t][0], mesh->tris[t][i]);
    for (size_t t = 0; t < mesh->tri_count; t++) {
        const uint32_t r[3] = { trimesh_root(root, mesh->tris[t][0]), trimesh_root(root, mesh->tris[t][1]),
                                trimesh_root(root, mesh->tris[t][2]) };
        double area_m2 = trimesh_tri_area(mesh, t);
        for (int i = 0; i < 3; i++)
            touched[mesh->tris[t][i]] |= hidden[t];
        for (int i = 0; i < (hidden[t] ? 3 : 1); i++)
            *(hidden[t] ? &islands[r[i]].hidden_m2 : &islands[r[i]].seen_m2) += area_m2;
    }
    for (uint32_t i = 0; i < mesh->point_count; i++)
        islands[trimesh_root(root, i)].free |= !touched[i];
    for (size_t t = 0; t < mesh->tri_count; t++) {
        const struct island *island = &islands[trimesh_root(root, mesh->tris[t][0])];
        hidden[t] = hidden[t] || (!island->free && island->seen_m2 < island->hidden_m2);
    }
    mem_free(root);
    mem_free(islands);
    mem_free(touched);
}

void interior_resolve_across(const struct trimesh *mesh, char *hidden)
{
    uint32_t *seen = mem_array(mesh->point_count, sizeof(*seen)), *group = mem_array(mesh->point_count, sizeof(*group));
    /* by lowest point of a group of connected INTERIOR_ACROSS triangles: a group of connected visible triangles that touches
       it, given by its lowest point; TRIMESH_NONE: none found yet */
    uint32_t *first = mem_array(mesh->point_count, sizeof(*first));
    char *is_seen = mem_array(mesh->point_count, 1), *joins = mem_array(mesh->point_count, 1);
    for (uint32_t i = 0; i < mesh->point_count; i++) {
        seen[i] = group[i] = i;
        first[i] = TRIMESH_NONE;
    }
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3 && hidden[t] != INTERIOR_INSIDE; i++) {
            is_seen[mesh->tris[t][i]] |= hidden[t] == INTERIOR_NOT;
            trimesh_join(hidden[t] ? group : seen, mesh->tris[t][0], mesh->tris[t][i]);
        }
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3 && hidden[t] == INTERIOR_ACROSS; i++) {
            uint32_t p = mesh->tris[t][i], g = trimesh_root(group, p), piece = trimesh_root(seen, p);
            if (!is_seen[p])
                continue;
            joins[g] |= first[g] != TRIMESH_NONE && first[g] != piece;
            first[g] = piece;
        }
    for (size_t t = 0; t < mesh->tri_count; t++)
        if (hidden[t] == INTERIOR_ACROSS)
            hidden[t] = joins[trimesh_root(group, mesh->tris[t][0])] ? INTERIOR_NOT : INTERIOR_INSIDE;
    mem_free(seen);
    mem_free(group);
    mem_free(first);
    mem_free(is_seen);
    mem_free(joins);
}
