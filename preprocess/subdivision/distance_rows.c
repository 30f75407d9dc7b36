/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows into columns, a tile at a time that fits into a core's own memory. */
#include "preprocess/subdivision/distance_rows.h"

#include <errno.h>
#include <stdatomic.h>

#include "base/mem.h"
#include "preprocess/cache/file_io.h"
#include "surface/mesh/trimesh.h"

#define LINE 16u            /* floats: sensors of a tile */
#define TILE 16384u         /* its vertices: 64 kB of a column are written at once */
#define APART (TILE + LINE) /* of a tile's columns, in floats, so that they do not meet in the cache */

void distance_rows_finish(struct distance_rows *rows)
{
    mem_free(rows->distances_m);
    mem_free(rows->place_of);
    *rows = (struct distance_rows){ 0 };
}

void distance_rows_renumber(struct distance_rows *rows, const uint32_t *new_of, uint32_t kept)
{
    uint32_t *place_of = mem_array(kept, sizeof(*place_of));
    for (uint32_t v = 0; v < rows->vertex_count; v++)
        if (new_of[v] != TRIMESH_NONE)
            place_of[new_of[v]] = rows->place_of[v];
    mem_free(rows->place_of);
    rows->place_of = place_of;
    rows->vertex_count = kept;
}

struct turn {
    const struct distance_rows *rows;
    int fd;
    off_t at;
    size_t lines;     /* tiles beside each other */
    atomic_int error; /* errno */
};

static void turn_tile(const struct distance_rows *rows, size_t first, size_t last, size_t line, size_t width, float *tile)
{
    for (size_t v = first; v < last; v++) {
        const float *row = rows->distances_m + rows->place_of[v] * rows->sensor_count + line;
        for (size_t s = 0; s < width; s++)
            tile[s * APART + v - first] = row[s];
    }
}

static void turn_tiles(void *arg, size_t begin, size_t end)
{
    struct turn *turn = arg;
    const struct distance_rows *rows = turn->rows;
    const size_t count = rows->vertex_count, sensors = rows->sensor_count;
    float *tile = mem_array(LINE * APART, sizeof(*tile));
    for (size_t i = begin; i < end && !turn->error; i++) {
        size_t first = i / turn->lines * TILE, line = i % turn->lines * LINE;
        size_t last = first + TILE < count ? first + TILE : count, width = line + LINE < sensors ? LINE : sensors - line;
        turn_tile(rows, first, last, line, width, tile);
        for (size_t s = 0; s < width; s++)
            if (!file_write(turn->fd, tile + s * APART, (last - first) * sizeof(*tile),
                            turn->at + (off_t)(((line + s) * count + first) * sizeof(*tile))))
                turn->error = errno;
    }
    mem_free(tile);
}

int distance_rows_write(const struct distance_rows *rows, struct workers *workers, int fd, off_t at)
{
    struct turn turn = { .rows = rows, .fd = fd, .at = at, .lines = (rows->sensor_count + LINE - 1) / LINE };
    size_t tiles = (rows->vertex_count + TILE - 1) / TILE * turn.lines;
    if (workers)
        workers_for(workers, tiles, 4, turn_tiles, &turn);
    else
        turn_tiles(&turn, 0, tiles);
    return turn.error;
}
