/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cuts every primitive into clusters: triangles that lie close together and look about the same way. */
#ifndef PREPROCESS_LEVELS_CLUSTERS_H
#define PREPROCESS_LEVELS_CLUSTERS_H
#include "base/workers.h"
#include "preprocess/levels/levels.h"

#define CLUSTERS_MAX_TRIANGLES 256 /* in one */

struct clusters {
    struct asset_cluster *at; /* primitive by primitive */
    uint32_t count;
    size_t capacity;
};

/* Begins to cut a level's primitives on an idle worker, and to bring the indices of each into the order of its clusters, good for a vertex
   cache within each. The level's arrays must stay where they are until clusters_end; positions are copied. workers may be NULL. */
struct clusters_making;
struct clusters_making *clusters_begin(struct workers *workers, const struct level *level, const float (*positions_m)[3],
                                       uint32_t vertex_count);
/* Adds them to those of finer levels, whose indices come first: so many. Leaves NULL. */
void clusters_end(struct clusters_making **making, uint32_t first_index, struct clusters *clusters);
void clusters_finish(struct clusters *clusters);

#endif
