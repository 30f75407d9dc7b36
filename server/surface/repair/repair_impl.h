/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Declarations shared by the files of mesh repair (repair*.c). */
#ifndef SURFACE_REPAIR_IMPL_H
#define SURFACE_REPAIR_IMPL_H
#include "surface/repair/mesh_edit.h"
#include "surface/repair/borders.h"
#include "surface/repair/repair.h"

#define REPAIR_AT_END 1e-3 /* a point counts as an end of an edge if it is nearer to it than this, as a fraction of the edge's length */

/* Applies the collected edits to the mesh, counts the bridges (pairs of joined points) in the report, and frees `edit`. The last
 * `crossings` points of the mesh are those at which an edge passes through a face. Each is inserted into both, but counts as one bridge. */
void repair_apply(struct mesh_edit *edit, struct trimesh *mesh, uint32_t *target, size_t target_count, size_t crossings,
                  struct repair_report *report);
/* Inserts the points of straight borders into edges that run along the border, at most within_m away, and share one end with
 * it. Several bodies meet at such an edge, and one has a slit. A point is inserted into all such edges, because the others
 * would stay open if only the nearest edge got the point. borders: borders of the mesh; updated. */
void repair_hanging(struct trimesh *mesh, struct borders *borders, double within_m, uint32_t *target, size_t target_count,
                    struct repair_report *report);

#endif
