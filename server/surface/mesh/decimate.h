/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decimation: removes points that mesh repair has inserted where the surface is flat. */
#ifndef SURFACE_MESH_DECIMATE_H
#define SURFACE_MESH_DECIMATE_H
#include "surface/mesh/trimesh.h"

/* Which points may go, and what must hold afterwards. */
struct decimate_params {
    const uint32_t *part; /* of each triangle */
    const char *keep;     /* of each point: it stays */
    double within_m;      /* the surface stays where it is to that */
    double longest_m;     /* edge that may come about */
};
/* Removes points by collapsing each into a neighbour, where all triangles at it stay in their planes (to params->within_m) and each part
   keeps its visible and hidden area, so that borders and lines where parts meet stay in place. hidden[tri] follows the triangles. Coplanar
   triangles of the model may become indistinguishable: plane[source] receives the lowest of them. target[point]: receives its new number,
   or TRIMESH_NONE if it is gone. */
void decimate_mesh(struct trimesh *mesh, char *hidden, const struct decimate_params *params, uint32_t *plane, size_t source_count,
                   uint32_t *target);

#endif
