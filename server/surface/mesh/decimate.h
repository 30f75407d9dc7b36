/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Taking points out of a mesh again that joining its parts has put in where the surface is flat. */
#ifndef SURFACE_MESH_DECIMATE_H
#define SURFACE_MESH_DECIMATE_H
#include "surface/mesh/trimesh.h"

struct decimate_params {
    const uint32_t *part; /* of each triangle */
    const char *keep;     /* of each point: it stays */
    double within_m;      /* the surface stays where it is to that */
    double longest_m;     /* edge that may come about */
};
/* A point goes where each triangle at it can take a neighbour of the point instead: stays in its plane and looks the same way, and each
   part keeps its area, seen and hidden, so that borders and lines where parts meet stay where they are. hidden[tri] follows the triangles.
   Of the model's triangles some that lie in one plane are then no longer told apart: plane[source] becomes the lowest that it is one with.
   target[point]: its new number; TRIMESH_NONE: it is gone. */
void decimate_mesh(struct trimesh *mesh, char *hidden, const struct decimate_params *params, uint32_t *plane, size_t source_count,
                   uint32_t *target);

#endif
