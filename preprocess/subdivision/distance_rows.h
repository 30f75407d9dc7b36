/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Distances place by place, as splitting finds them; turned into columns vertex by vertex, as an asset file has them. */
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

void distance_rows_finish(struct distance_rows *rows); /* a zeroed one is fine */
/* Vertices follow to their new numbers; those without one (TRIMESH_NONE) are dropped, and `kept` are left. */
void distance_rows_renumber(struct distance_rows *rows, const uint32_t *new_of, uint32_t kept);
/* Columns, [sensor][vertex], into a file from `at` on: where a mapped one is stored to instead, each page costs as much again. workers may
   be NULL. Returns 0, or the errno of what could not be written. */
int distance_rows_write(const struct distance_rows *rows, struct workers *workers, int fd, off_t at);

#endif
