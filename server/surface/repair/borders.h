/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lists the border edges of a mesh (edges with one face) and the points on them. */
#ifndef SURFACE_REPAIR_BORDERS_H
#define SURFACE_REPAIR_BORDERS_H
#include "surface/repair/parts.h"

struct borders {
    /* edges: the two points of each border edge (an edge with one face); edge_tri: by border edge, its one triangle */
    uint32_t (*edges)[2], *edge_tri;
    size_t edge_count;
    uint32_t *points; /* points on border edges */
    size_t point_count;
    uint32_t *slot; /* by mesh point: index of the point in `points`; TRIMESH_NONE: the point is on no border edge */
    /* by border point: length of the shortest edge of any triangle at it, which limits the gaps that are closed there */
    double *shortest_m;
    /* edges at the border points: those at border point i have the indices at[first[i]] to at[first[i + 1] - 1] in `edges` */
    uint32_t *first, *at;
    /* by border point: smallest reach (distance up to which a part counts as touching, parts.h) of the parts at it; NULL: not computed */
    double *reach_m;
};

/* Collects all border edges of a mesh, and the points on them. Keeps no pointer to the mesh. Free with borders_finish(). */
void borders_init(struct borders *borders, const struct trimesh *mesh);
/* Collects only those border edges of `seen` (the visible triangles) whose other faces are hidden. Also finds the reach
 * (distance up to which a part counts as touching) of the parts at these edges. */
void borders_init_rims(struct borders *borders, const struct trimesh *seen, const struct trimesh *hidden, const struct body_parts *parts);
/* Frees the lists. */
void borders_finish(struct borders *borders);

#endif
