/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Vertices that lie at one place. */
#include "preprocess/places.h"

#include <meshoptimizer.h>
#include <string.h>

#include "base/mem.h"

bool places_init(struct places *places, const float (*positions_m)[3], size_t vertex_count)
{
    *places = (struct places){ 0 };
    places->of_vertex = mem_try_array(vertex_count, sizeof(*places->of_vertex));
    places->positions_m = mem_try_array(vertex_count, sizeof(*places->positions_m));
    if (!places->of_vertex || !places->positions_m) {
        places_finish(places);
        return false;
    }
    places->count = meshopt_generateVertexRemap(places->of_vertex, NULL, vertex_count, positions_m, vertex_count, sizeof(*positions_m));
    meshopt_remapVertexBuffer(places->positions_m, positions_m, vertex_count, sizeof(*positions_m), places->of_vertex);
    return true;
}

void places_finish(struct places *places)
{
    mem_free(places->of_vertex);
    mem_free(places->positions_m);
    *places = (struct places){ 0 };
}
