/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Points and triangles in an order in which what is near is near in memory. */
#ifndef SURFACE_MESH_SPATIAL_ORDER_H
#define SURFACE_MESH_SPATIAL_ORDER_H
#include "surface/mesh/trimesh.h"

/* Points along a Morton curve, triangles by their first point, those from `visible_count` on apart from those before. target[point]: its
   new number. */
void spatial_order_mesh(struct trimesh *mesh, size_t visible_count, uint32_t *target);

#endif
