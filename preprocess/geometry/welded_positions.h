/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Maps vertices to distinct positions: vertices with bitwise equal positions get the same index, even if their normals or
 * texture coordinates differ. */
#ifndef PREPROCESS_GEOMETRY_WELDED_POSITIONS_H
#define PREPROCESS_GEOMETRY_WELDED_POSITIONS_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct welded_positions {
    uint32_t *of_vertex;
    float (*positions_m)[3];
    size_t count;
};

/* Builds the map from vertices to distinct positions. Returns false if out of memory; welded_finish() then need not be called. */
bool welded_init(struct welded_positions *welded, const float (*positions_m)[3], size_t vertex_count);
/* Frees the arrays of the map from vertices to positions. */
void welded_finish(struct welded_positions *welded);

#endif
