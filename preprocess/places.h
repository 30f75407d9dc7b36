/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Vertices that lie at one place, whatever their other attributes. */
#ifndef PREPROCESS_PLACES_H
#define PREPROCESS_PLACES_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct places {
    uint32_t *of_vertex;
    float (*positions_m)[3];
    size_t count;
};

/* False: out of memory; nothing to finish. */
bool places_init(struct places *places, const float (*positions_m)[3], size_t vertex_count);
void places_finish(struct places *places);

#endif
