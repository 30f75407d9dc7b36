/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files that find parts and their orientation (parts*.c). */
#ifndef SURFACE_REPAIR_PARTS_IMPL_H
#define SURFACE_REPAIR_PARTS_IMPL_H
#include "surface/mesh/tri_edges.h"
#include "surface/repair/parts.h"

struct parts_finding {
    struct body_parts *parts;
    struct tri_edges edges;
    uint32_t *patch;       /* patch of each triangle, named by its lowest triangle */
    struct surface_patch { /* measures of a patch, indexed by the patch's lowest triangle */
        /* open_m: total length of edges with one face; branching_m: total length of edges with three or more faces, of which exactly one is
         * the patch's */
        double open_m, branching_m, area_m2;
        double doubles_m2; /* area of triangles with at least twice the multiplicity of the other triangles of the part */
        bool loose;        /* true: the patch is open and only stands on other patches, like a fin */
    } * patches;
};

/* Finds edges, patches and parts of parts->solid, decides which are closed, and assigns bodies to the triangles of `mesh`, which equal the
   solid's. */
void parts_number(struct parts_finding *f, const struct trimesh *mesh);

#endif
