/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Orders an asset's vertices for the asset file: those of the coarsest level first, so that each level uses a prefix. */
#ifndef PREPROCESS_LEVELS_VERTEX_ORDER_H
#define PREPROCESS_LEVELS_VERTEX_ORDER_H
#include "preprocess/levels/levels.h"
#include "surface/mesh/trimesh.h" /* TRIMESH_NONE */

/* Renumbers the geometry's vertices, drops those from first_added on that no level uses, and makes the geometry's indices and primitives
   those of all levels, finest first; the levels themselves keep the old numbers. Fills out[level] and *new_of (old vertex to new, or
   TRIMESH_NONE; the caller frees it, mem_free). Returns false if out of memory, with the geometry unchanged. */
bool vertex_order_apply(struct geometry *geometry, const struct levels *levels, uint32_t first_added, struct asset_level out[LEVELS_MAX],
                        uint32_t **new_of);

#endif
