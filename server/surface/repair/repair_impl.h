/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of the bridging share. */
#ifndef SURFACE_REPAIR_IMPL_H
#define SURFACE_REPAIR_IMPL_H
#include "surface/repair/mesh_edit.h"
#include "surface/repair/borders.h"
#include "surface/repair/repair.h"

#define REPAIR_AT_END 1e-3 /* this near to an end of an edge, as a share of its length, it is the end */

bool repair_tri_has(const struct trimesh *mesh, uint32_t tri, uint32_t point);
/* Applies what was collected, and counts it; the last `crossings` points of the mesh are each set into two places. Finishes attach. */
void repair_apply(struct mesh_edit *edit, struct trimesh *mesh, uint32_t *target, size_t target_count, size_t crossings,
                  struct repair_report *report);
/* Sets points of straight open borders into edges of several bodies, one of which has a slit there, that run along the border and have one
   end with it in common: what fits exactly. Into all of them: set into the nearest only, two points in one edge close with each other, and
   the edge itself stays open. borders are those of the mesh, before and after. */
void repair_hanging(struct trimesh *mesh, struct borders *borders, double within_m, uint32_t *target, size_t target_count,
                    struct repair_report *report);

#endif
