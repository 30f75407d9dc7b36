/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Puts an asset's vertices in the order of the asset file: those of the coarsest level first, so that each level uses a prefix. */
#ifndef PREPROCESS_LEVELS_VERTEX_ORDER_H
#define PREPROCESS_LEVELS_VERTEX_ORDER_H
#include "preprocess/levels/levels.h"
#include "surface/mesh/trimesh.h" /* TRIMESH_NONE */

/* Renumbers the geometry's vertices and makes its indices and primitives those of all levels, finest first; the levels' own indices keep
   the old numbers. Vertices from first_added on are not the model's: those that no level uses are dropped. out[level]; new_of[old vertex]
   gives the new number, or TRIMESH_NONE (free with mem_free). False: out of memory; the geometry is as it was. */
bool vertex_order_apply(struct geometry *geometry, const struct levels *levels, uint32_t first_added, struct asset_level out[LEVELS_MAX],
                        uint32_t **new_of);

#endif
