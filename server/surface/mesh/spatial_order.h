/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Spatial ordering: renumbers points and triangles so that what is near in space is near in memory. */
#ifndef SURFACE_MESH_SPATIAL_ORDER_H
#define SURFACE_MESH_SPATIAL_ORDER_H
#include "surface/mesh/trimesh.h"

/* Sorts the mesh's points along a Morton curve and its triangles by their first point, those from visible_count on after those before it.
   target[point]: receives its new number. */
void spatial_order_mesh(struct trimesh *mesh, size_t visible_count, uint32_t *target);

#endif
