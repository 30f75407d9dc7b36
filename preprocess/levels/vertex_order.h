/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Orders an asset's vertices for the asset file: those of the coarsest level of detail come first, so that each level uses only
 * the beginning of the array. */
#ifndef PREPROCESS_LEVELS_VERTEX_ORDER_H
#define PREPROCESS_LEVELS_VERTEX_ORDER_H
#include "preprocess/levels/levels.h"
#include "surface/mesh/trimesh.h" /* declares TRIMESH_NONE */

/* Renumbers the geometry's vertices, and drops unused ones with index first_added or higher. Replaces the geometry's indices
 * and primitives by those of all levels, finest first. The levels themselves keep the old numbers. Fills out[level]. *new_of
 * receives the new index of each old vertex, or TRIMESH_NONE if dropped; the caller frees it (mem_free). Returns false if out
 * of memory, leaving the geometry unchanged. */
bool vertex_order_apply(struct geometry *geometry, const struct levels *levels, uint32_t first_added, struct asset_level out[LEVELS_MAX],
                        uint32_t **new_of);

#endif
