/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Distances computed during subdivision, stored as one row of sensors per position; written to the asset file as it has them, in blocks of
   vertices, sensor by sensor. */
#ifndef PREPROCESS_SUBDIVISION_DISTANCE_ROWS_H
#define PREPROCESS_SUBDIVISION_DISTANCE_ROWS_H
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "base/workers.h"

struct distance_rows {
    float *distances_m; /* [place][sensor] */
    uint32_t *place_of; /* of each vertex */
    size_t sensor_count;
    uint32_t vertex_count;
};

/* Frees the arrays. A zeroed one is fine. */
void distance_rows_finish(struct distance_rows *rows);
/* Renumbers the vertices by new_of (TRIMESH_NONE: dropped), after which there are `kept` of them. */
void distance_rows_renumber(struct distance_rows *rows, const uint32_t *new_of, uint32_t kept);
/* Writes the codes of an asset file (protocol/asset_distance.h) to fd from offset `at` on. It writes rather than storing through a mapping,
   which would cost as much again for each page. workers may be NULL. Returns 0 or an errno. */
int distance_rows_write(const struct distance_rows *rows, struct workers *workers, int fd, off_t at);

#endif
