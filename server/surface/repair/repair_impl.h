/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of mesh repair (repair*.c). */
#ifndef SURFACE_REPAIR_IMPL_H
#define SURFACE_REPAIR_IMPL_H
#include "surface/repair/mesh_edit.h"
#include "surface/repair/borders.h"
#include "surface/repair/repair.h"

#define REPAIR_AT_END 1e-3 /* a point within this fraction of an edge's length from its end counts as the end */

/* Returns whether the triangle has this point as a corner. */
bool repair_tri_has(const struct trimesh *mesh, uint32_t tri, uint32_t point);
/* Applies the collected edits to the mesh, counts the bridges in the report, and frees the edit. The last `crossings` points of the mesh
   are each inserted in two places and count once. */
void repair_apply(struct mesh_edit *edit, struct trimesh *mesh, uint32_t *target, size_t target_count, size_t crossings,
                  struct repair_report *report);
/* Inserts points of straight borders into edges that run along the border and share one end with it. At such an edge several bodies meet,
 * of which one has a slit. Used for exact fits. A point is inserted into all such edges: if it were inserted into the nearest only, others
 * would stay open. borders: of the mesh; updated. */
void repair_hanging(struct trimesh *mesh, struct borders *borders, double within_m, uint32_t *target, size_t target_count,
                    struct repair_report *report);

#endif
