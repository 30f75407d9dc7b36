/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Partitions each primitive into clusters: adjacent triangles that face about the same way, so that they can be culled together. */
#ifndef PREPROCESS_LEVELS_CLUSTERS_H
#define PREPROCESS_LEVELS_CLUSTERS_H
#include "base/workers.h"
#include "preprocess/levels/levels.h"

#define CLUSTERS_MAX_TRIANGLES 256 /* triangles per cluster */

struct clusters {
    struct asset_cluster *at; /* clusters, in the order of the primitives */
    uint32_t count;
    size_t capacity;
};

struct clusters_making;
/* Starts, on an idle worker, partitioning a level's primitives; reorders the indices of each by cluster, and within a cluster for the
   vertex cache. Positions are copied; the level's arrays must stay in place until clusters_end(). workers NULL: does the work at once.
   Returns the job for clusters_end(). */
struct clusters_making *clusters_begin(struct workers *workers, const struct level *level, const float (*positions_m)[3],
                                       uint32_t vertex_count);
/* Waits for the job and appends the clusters to *clusters. first_index: position of the level's indices in the asset file, added to each
 * cluster's index offset. Frees the job and sets *making to NULL. */
void clusters_end(struct clusters_making **making, uint32_t first_index, struct clusters *clusters);
/* Frees the array. */
void clusters_finish(struct clusters *clusters);

#endif
