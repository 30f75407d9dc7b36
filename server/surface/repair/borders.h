/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Border edges of a mesh (edges with one face) and the points on them. */
#ifndef SURFACE_REPAIR_BORDERS_H
#define SURFACE_REPAIR_BORDERS_H
#include "surface/repair/parts.h"

struct borders {
    uint32_t (*edges)[2], *edge_tri; /* open edges and their one triangle */
    size_t edge_count;
    uint32_t *points; /* points on them */
    size_t point_count;
    uint32_t *slot;       /* point -> place in points, or TRIMESH_NONE */
    double *shortest_m;   /* of each point in points: the shortest edge of any triangle at it */
    uint32_t *first, *at; /* open edges at each point in points */
    double *reach_m;      /* of each point in points: the least of its parts; NULL: not asked for */
};

/* Collects all border edges of a mesh, and the points on them. Keeps no pointer to the mesh. Free with borders_finish(). */
void borders_init(struct borders *borders, const struct trimesh *mesh);
/* Collects only those border edges of `seen` that are open because the other faces at them are hidden, with the reach of their parts. */
void borders_init_rims(struct borders *borders, const struct trimesh *seen, const struct trimesh *hidden, const struct body_parts *parts);
/* Frees the lists. */
void borders_finish(struct borders *borders);

#endif
