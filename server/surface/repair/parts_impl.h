/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files that find parts and their orientation (parts*.c). */
#ifndef SURFACE_REPAIR_PARTS_IMPL_H
#define SURFACE_REPAIR_PARTS_IMPL_H
#include "surface/mesh/tri_edges.h"
#include "surface/repair/parts.h"

struct parts_finding {
    struct body_parts *parts;
    struct tri_edges edges;
    uint32_t *patch;                         /* of each triangle: its lowest one */
    struct surface_patch {                   /* by its lowest triangle */
        double open_m, branching_m, area_m2; /* edges with one face; with three or more, of which it has only one */
        double doubles_m2;                   /* of triangles that are there twice as often as others of the part */
        bool loose;                          /* it stands on others, and is open */
    } * patches;
};

/* Finds edges, patches and parts of parts->solid, which of them are closed, and the bodies of mesh, whose triangles are the solid's. */
void parts_number(struct parts_finding *f, const struct trimesh *mesh);

#endif
