/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decimation: removes points that mesh repair inserted, where the surface is flat. */
#ifndef SURFACE_MESH_DECIMATE_H
#define SURFACE_MESH_DECIMATE_H
#include "surface/mesh/trimesh.h"

/* input of decimate_mesh(): the points that may be removed, and the conditions for removing them */
struct decimate_params {
    const uint32_t *part; /* per triangle */
    const char *keep;     /* by point: 1: decimation must not remove the point */
    double within_m;      /* largest displacement of the surface */
    double longest_m;     /* maximum length in metres of an edge that a collapse may create */
};
/* Removes points by merging each with a neighbour (edge collapse). This is done only if all triangles at the point stay in
   their planes (within params->within_m), and the visible and the hidden area of each part stay the same, so that borders and
   lines between parts stay in place. hidden[] is rearranged with the triangles. Pieces of coplanar model triangles may be
   merged. plane: by model triangle, a union-find structure of model triangles that share pieces already (trimesh_root());
   plane[source] receives the lowest index of the model triangles that share pieces with triangle `source`. target[point]: receives
   the point's new index, or TRIMESH_NONE if the point is removed. */
void decimate_mesh(struct trimesh *mesh, char *hidden, const struct decimate_params *params, uint32_t *plane, size_t source_count,
                   uint32_t *target);

#endif
