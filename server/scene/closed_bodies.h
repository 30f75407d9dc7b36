/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which triangles of a level bound closed bodies: what a cut through those opens is solid. A body is all that hangs together by places
   of vertices; it is closed where each edge is run along as often one way as the other. Thread: any. */
#ifndef SCENE_CLOSED_BODIES_H
#define SCENE_CLOSED_BODIES_H
#include <stddef.h>

#include "protocol/asset_format.h"

struct closed_run {
    uint32_t first_index, index_count;
};

struct closed_bodies {
    struct closed_run *runs; /* ascending */
    size_t run_count, run_capacity;
};

/* Only of opaque materials. Out of memory, or too large to look at while somebody waits: none are. */
void closed_bodies_find(const struct asset_view *view, uint32_t level, struct closed_bodies *out);
void closed_bodies_finish(struct closed_bodies *closed);

#endif
