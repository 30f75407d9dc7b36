/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts distances from one row of sensors per position into the asset file's blocks of vertices. */
#include "preprocess/subdivision/distance_rows.h"

#include <errno.h>
#include <stdatomic.h>

#include "base/mem.h"
#include "preprocess/cache/file_io.h"
#include "protocol/asset_distance.h"
#include "surface/mesh/trimesh.h"

/* offset in numbers between the output lines of consecutive sensors, chosen so that the lines do not evict each other from the CPU cache */
#define APART (ASSET_DISTANCE_BLOCK + 32)
#define AHEAD 8  /* prefetch distance in vertices: the next vertex's row is probably not in the CPU cache */
#define LINE 32u /* sensors processed at a time, so that their output lines fit the first-level cache */

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

struct rows_block {
    const struct distance_rows *rows;
    int fd;
    off_t at;
    atomic_int error; /* errno of the first failed write; 0: all writes succeeded */
};

static void fetch_row(const struct distance_rows *rows, size_t vertex, size_t begin, size_t width)
{
    const char *row = (const char *)(rows->distances_m + rows->place_of[vertex] * rows->sensor_count + begin);
    for (size_t at = 0; at < width * sizeof(float); at += 64)
        __builtin_prefetch(row + at);
}

/* Converts the distances of one block of vertices to 16-bit codes (protocol/asset_distance.h), sensor by sensor. */
static void turn_block(const struct distance_rows *rows, size_t first, size_t count, uint16_t *codes)
{
    uint16_t line[LINE * APART];
    for (size_t begin = 0; begin < rows->sensor_count; begin += LINE) {
        size_t width = begin + LINE < rows->sensor_count ? LINE : rows->sensor_count - begin;
        for (size_t v = 0; v < count; v++) {
            const float *row = rows->distances_m + rows->place_of[first + v] * rows->sensor_count + begin;
            uint16_t code[LINE];
            if (v + AHEAD < count)
                fetch_row(rows, first + v + AHEAD, begin, width);
            for (size_t s = 0; s < width; s++)
                code[s] = asset_distance_code(row[s]);
            for (size_t s = 0; s < width; s++)
                line[s * APART + v] = code[s];
        }
        for (size_t s = 0; s < width; s++) {
            uint16_t *to = codes + (begin + s) * ASSET_DISTANCE_BLOCK;
            memcpy(to, line + s * APART, count * sizeof(*to));
            for (size_t v = count; v < ASSET_DISTANCE_BLOCK; v++)
                to[v] = ASSET_DISTANCE_NONE;
        }
    }
}

static void turn_blocks(void *arg, size_t begin, size_t end)
{
    struct rows_block *turn = arg;
    const struct distance_rows *rows = turn->rows;
    const size_t bytes = rows->sensor_count * ASSET_DISTANCE_BLOCK * sizeof(uint16_t);
    uint16_t *codes = mem_array(rows->sensor_count, ASSET_DISTANCE_BLOCK * sizeof(*codes));
    for (size_t block = begin; block < end && !turn->error; block++) {
        size_t first = block * ASSET_DISTANCE_BLOCK, left = rows->vertex_count - first;
        turn_block(rows, first, left < ASSET_DISTANCE_BLOCK ? left : ASSET_DISTANCE_BLOCK, codes);
        if (!file_write(turn->fd, codes, bytes, turn->at + (off_t)(block * bytes)))
            turn->error = errno;
    }
    mem_free(codes);
}

int distance_rows_write(const struct distance_rows *rows, struct workers *workers, int fd, off_t at)
{
    struct rows_block turn = { .rows = rows, .fd = fd, .at = at };
    size_t blocks = (rows->vertex_count + ASSET_DISTANCE_BLOCK - 1) / ASSET_DISTANCE_BLOCK;
    if (workers)
        workers_for(workers, blocks, 16, turn_blocks, &turn);
    else
        turn_blocks(&turn, 0, blocks);
    return turn.error;
}
