/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Partitions each primitive into clusters: triangles that lie close together and face about the same way, so that they can be culled
   together. */
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
/* Starts, on an idle worker, partitioning a level's primitives; reorders the indices of each by cluster, and within a cluster for the
   vertex cache. Positions are copied; the level's arrays must stay in place until clusters_end(). workers NULL: does the work at once.
   Returns the job for clusters_end(). */
struct clusters_making *clusters_begin(struct workers *workers, const struct level *level, const float (*positions_m)[3],
                                       uint32_t vertex_count);
/* Waits for the job and appends its clusters to *clusters, whose index counts from first_index, the number of indices of finer levels.
   Frees the job; leaves NULL. */
void clusters_end(struct clusters_making **making, uint32_t first_index, struct clusters *clusters);
/* Frees the list. */
void clusters_finish(struct clusters *clusters);

#endif
