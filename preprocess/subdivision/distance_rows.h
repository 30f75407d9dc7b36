/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Distances computed during subdivision: one row per position, with one distance per sensor. Written to the asset file in its
 * format: blocks of vertices, sensor by sensor. */
#ifndef PREPROCESS_SUBDIVISION_DISTANCE_ROWS_H
#define PREPROCESS_SUBDIVISION_DISTANCE_ROWS_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "base/workers.h"

struct distance_rows {
    float *distances_m; /* [position][sensor]: distance in metres */
    uint32_t *place_of; /* by vertex: index of its position */
    size_t sensor_count;
    uint32_t vertex_count;
    /* set by distance_rows_pack(): packed blocks of vertices, and each block's offset in the asset file's distances section */
    uint8_t **packed;
    uint64_t *offsets;
    size_t packed_bytes; /* bytes of the asset file's packed distances section; 0: the distances are not packed */
};

/* Frees the arrays of an initialised or zeroed struct distance_rows. */
void distance_rows_finish(struct distance_rows *rows);
/* Renumbers the vertices: new_of[old index] is the new index, or TRIMESH_NONE for a dropped vertex. kept: number of vertices afterwards. */
void distance_rows_renumber(struct distance_rows *rows, const uint32_t *new_of, uint32_t kept);
/* Packs the distances of many sensors (protocol/distance_pack.h) and frees distances_m. Leaves them unpacked for few sensors,
 * or if packing saves no bytes: readers recognise a packed section by its length. workers may be NULL. Returns false if out of
 * memory. */
bool distance_rows_pack(struct distance_rows *rows, struct workers *workers);
/* Writes the distances to fd, from offset `at` on: packed, or as plain 16-bit codes (protocol/asset_distance.h). Uses write(),
 * because the page faults of a mapping would double the cost. workers may be NULL. Returns 0 or an errno value. */
int distance_rows_write(const struct distance_rows *rows, struct workers *workers, int fd, off_t at);

#endif
