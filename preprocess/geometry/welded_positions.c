/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds vertices with equal positions. */
#include "preprocess/geometry/welded_positions.h"

#include <meshoptimizer.h>

#include "base/mem.h"

bool welded_init(struct welded_positions *welded, const float (*positions_m)[3], size_t vertex_count)
{
    *welded = (struct welded_positions){ 0 };
    welded->of_vertex = mem_try_array(vertex_count, sizeof(*welded->of_vertex));
    welded->positions_m = mem_try_array(vertex_count, sizeof(*welded->positions_m));
    if (!welded->of_vertex || !welded->positions_m) {
        welded_finish(welded);
        return false;
    }
    welded->count = meshopt_generateVertexRemap(welded->of_vertex, NULL, vertex_count, positions_m, vertex_count, sizeof(*positions_m));
    meshopt_remapVertexBuffer(welded->positions_m, positions_m, vertex_count, sizeof(*positions_m), welded->of_vertex);
    return true;
}

void welded_finish(struct welded_positions *welded)
{
    mem_free(welded->of_vertex);
    mem_free(welded->positions_m);
    *welded = (struct welded_positions){ 0 };
}
