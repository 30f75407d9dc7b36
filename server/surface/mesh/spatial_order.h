/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Spatial ordering: renumbers points and triangles so that neighbours in space are neighbours in memory. */
#ifndef SURFACE_MESH_SPATIAL_ORDER_H
#define SURFACE_MESH_SPATIAL_ORDER_H
#include "surface/mesh/trimesh.h"

/* Sorts the mesh's points along a Morton curve and its triangles by their first point. Hidden triangles, from index
   visible_count on, stay after the others. target[point]: receives the point's new index. */
void spatial_order_mesh(struct trimesh *mesh, size_t visible_count, uint32_t *target);

#endif
