/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decimation: removes points that mesh repair inserted, where the surface is flat. */
#ifndef SURFACE_MESH_DECIMATE_H
#define SURFACE_MESH_DECIMATE_H
#include "surface/mesh/trimesh.h"

/* Input of decimate_mesh(): which points may be removed, and the conditions to keep. */
struct decimate_params {
    const uint32_t *part; /* per triangle */
    const char *keep;     /* 1 for points that must stay */
    double within_m;      /* largest displacement of the surface */
    double longest_m;     /* longest edge that may be created */
};
/* Removes points by collapsing each into a neighbour, where all triangles at the point stay in their planes (within params->within_m) and
 * each part keeps its visible and hidden area, so that borders and lines between parts stay in place. hidden[tri]: moves with the
 * triangles. Pieces of coplanar model triangles may be merged: plane[source] receives the lowest such triangle. target[point]: receives the
 * point's new index, or TRIMESH_NONE if the point is removed. */
void decimate_mesh(struct trimesh *mesh, char *hidden, const struct decimate_params *params, uint32_t *plane, size_t source_count,
                   uint32_t *target);

#endif
