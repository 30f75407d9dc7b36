/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cuts every primitive into clusters: triangles that lie close together and look about the same way. */
#ifndef PREPROCESS_CLUSTERS_H
#define PREPROCESS_CLUSTERS_H
#include "base/workers.h"
#include "preprocess/geometry.h"

#define CLUSTERS_MAX_TRIANGLES 256 /* in one */

struct clusters {
    struct asset_cluster *at; /* primitive by primitive */
    uint32_t count;
};

/* Brings each primitive's indices into the order of its clusters, good for a vertex cache within each. workers may be NULL. */
void clusters_make(struct clusters *clusters, struct geometry *geometry, struct workers *workers);
void clusters_finish(struct clusters *clusters);

#endif
