/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Merges points that are closer together than distances along surfaces need. Rims of holes and ends of tubes may have thousands of
 * needle-shaped triangles, which would leave too few samples for the rest of the surface, and make distances inexact. */
#ifndef SURFACE_MESH_SHORT_SIDES_H
#define SURFACE_MESH_SHORT_SIDES_H
#include "surface/mesh/trimesh.h"

/* Merges the ends of sides of needle-shaped triangles, where the surface or its border is almost straight. size_m: size of the
   model. tolerance_m: the asset's tolerance. The surface moves by at most the smaller of SHORT_SIDES_WITHIN of the size and a tenth of the
   tolerance, so that places on the model still count as on the surface. Merged points stay in the mesh, without triangles. Triangles
   without area are dropped. plane: by model triangle (tri_source), a union-find structure (trimesh_root()); the sets of model
   triangles that share pieces are joined. Returns the number of merged points; 0 if memory runs out. */
#define SHORT_SIDES_WITHIN 2e-5
size_t short_sides_merge(struct trimesh *mesh, double size_m, double tolerance_m, uint32_t *plane);

#endif
