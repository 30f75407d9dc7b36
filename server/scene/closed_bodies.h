/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds which triangles of a level bound closed bodies, whose cut sections are drawn solid. A body is a set of triangles
   connected by vertex positions; it is closed if each edge is used equally often in both directions. Call from any thread. */
#ifndef SCENE_CLOSED_BODIES_H
#define SCENE_CLOSED_BODIES_H
#include <stddef.h>

#include "protocol/asset_format.h"

struct closed_run {
    uint32_t first_index, index_count;
};

struct closed_bodies {
    struct closed_run *runs; /* runs of indices in the index array, ascending by first_index */
    size_t run_count, run_capacity;
};

/* Finds the closed bodies among the triangles with opaque materials. Finds none if memory runs out, or if the level of detail
   is too large to examine while a user waits. */
void closed_bodies_find(const struct asset_view *view, uint32_t level, struct closed_bodies *out);
void closed_bodies_finish(struct closed_bodies *closed);

#endif
