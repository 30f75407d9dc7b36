/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Border edges of a mesh (edges with one face) and the points on them. */
#ifndef SURFACE_REPAIR_BORDERS_H
#define SURFACE_REPAIR_BORDERS_H
#include "surface/repair/parts.h"

struct borders {
    uint32_t (*edges)[2], *edge_tri; /* border edges, and the one triangle at each */
    size_t edge_count;
    uint32_t *points; /* points on border edges */
    size_t point_count;
    uint32_t *slot;       /* index of each point in `points`, or TRIMESH_NONE */
    double *shortest_m;   /* shortest edge of any triangle at each border point */
    uint32_t *first, *at; /* range of each border point's edges: from at[first[i]] to before at[first[i + 1]] */
    double *reach_m;      /* smallest reach (parts.h) of the parts at each border point; NULL: not computed */
};

/* Collects all border edges of a mesh, and the points on them. Keeps no pointer to the mesh. Free with borders_finish(). */
void borders_init(struct borders *borders, const struct trimesh *mesh);
/* Collects only border edges of `seen` whose other faces are hidden, and the reach of the parts (parts.h) at them. */
void borders_init_rims(struct borders *borders, const struct trimesh *seen, const struct trimesh *hidden, const struct body_parts *parts);
/* Frees the lists. */
void borders_finish(struct borders *borders);

#endif
