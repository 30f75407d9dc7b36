/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Partitions each primitive into clusters: groups of adjacent triangles that face in similar directions, so that the renderer can skip them
 * together. */
#ifndef PREPROCESS_LEVELS_CLUSTERS_H
#define PREPROCESS_LEVELS_CLUSTERS_H
#include "base/workers.h"
#include "preprocess/levels/levels.h"

#define CLUSTERS_MAX_TRIANGLES 256 /* triangles per cluster */

struct clusters {
    struct asset_cluster *at; /* clusters of all primitives, sorted by primitive */
    uint32_t count;
    size_t capacity;
};

struct clusters_making;
/* Starts partitioning a level of detail's primitives into clusters on an idle worker. The job sorts each primitive's indices by
 * cluster, and within a cluster in an order that suits the GPU's vertex cache. Positions are copied; the level's arrays must
 * stay in place until clusters_end(). workers NULL: does the work before returning. Returns the job for clusters_end(). */
struct clusters_making *clusters_begin(struct workers *workers, const struct level *level, const float (*positions_m)[3],
                                       uint32_t vertex_count);
/* Waits for the job of clusters_begin() and appends its clusters to *clusters. first_index: where the level's indices begin in
 * the asset file's index array; added to each cluster's index offset. Frees the job and sets *making to NULL. */
void clusters_end(struct clusters_making **making, uint32_t first_index, struct clusters *clusters);
/* Frees the array. */
void clusters_finish(struct clusters *clusters);

#endif
