/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Declarations shared by the files parts*.c, which find the parts of a surface and orient their triangles outwards. */
#ifndef SURFACE_REPAIR_PARTS_IMPL_H
#define SURFACE_REPAIR_PARTS_IMPL_H
#include "surface/mesh/tri_edges.h"
#include "surface/repair/parts.h"

struct parts_finding {
    struct body_parts *parts;
    struct tri_edges edges;
    /* by triangle: its patch (triangles connected by edges with two faces), identified by the lowest triangle index */
    uint32_t *patch;
    struct surface_patch { /* a patch (triangles connected by edges with two faces), stored at the index of its lowest triangle */
        /* for a patch (triangles connected by edges with two faces). open_m: total length of its edges with one face.
           branching_m: total length of its edges with three or more faces, only one of which belongs to the patch */
        double open_m, branching_m, area_m2;
        /* Area of the patch's triangles that occur in the model at least twice as often as the part's least frequent triangle.
           If it is most of the patch's area, the patch may be a wall between two bodies. */
        double doubles_m2;
        /* true: the patch (triangles connected by edges with two faces) is open and only stands on other patches, like a fin on
           a tube */
        bool loose;
    } * patches;
};

/* Finds edges, patches (triangles connected by edges with two faces) and parts of parts->solid, and decides which parts are
 * closed. Assigns bodies to the triangles of `mesh`, which are those of parts->solid. */
void parts_number(struct parts_finding *f, const struct trimesh *mesh);

#endif
