/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts distances from one row of sensors per position to the asset file's blocks of vertices, and packs these. */
#include "preprocess/subdivision/distance_rows.h"

#include <errno.h>
#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "base/mem.h"
#include "preprocess/cache/file_io.h"
#include "protocol/asset_distance.h"
#include "protocol/distance_pack.h"
#include "surface/mesh/trimesh.h"

/* distance, in 16-bit numbers, between the buffers of consecutive sensors' codes; the 32 extra numbers keep the buffers from
   evicting each other from the CPU cache */
#define APART (ASSET_DISTANCE_BLOCK + 32)
#define AHEAD 8  /* number of vertices ahead whose row of distances is prefetched, because that row is probably not in the CPU cache */
#define LINE 32u /* number of sensors processed at a time, so that the buffers with their codes fit into the first-level cache */

static size_t blocks_of(const struct distance_rows *rows)
{
    return (rows->vertex_count + ASSET_DISTANCE_BLOCK - 1) / ASSET_DISTANCE_BLOCK;
}

void distance_rows_finish(struct distance_rows *rows)
{
    for (size_t b = 0; rows->packed && b < blocks_of(rows); b++)
        mem_free(rows->packed[b]);
    mem_free(rows->packed);
    mem_free(rows->offsets);
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
    atomic_int error; /* errno of the first failed write of distances; 0: none failed */
};

static void fetch_row(const struct distance_rows *rows, size_t vertex, size_t begin, size_t width)
{
    const char *row = (const char *)(rows->distances_m + rows->place_of[vertex] * rows->sensor_count + begin);
    for (size_t at = 0; at < width * sizeof(float); at += 64)
        __builtin_prefetch(row + at);
}

/* Converts the distances of a block of vertices to the asset file's 16-bit codes (protocol/asset_distance.h), sensor by sensor. */
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

#define SAMPLES 40u /* number of vertices at which two sensors' distances are compared */

/* --- packing ---------------------------------------------------------------------------------------------------------------- */

struct packing {
    struct distance_rows *rows;
    uint16_t (*near)[DISTANCE_PACK_NEAR];
    atomic_bool failed;
};

static void insert_near(uint16_t near[DISTANCE_PACK_NEAR], float apart_m[DISTANCE_PACK_NEAR], uint16_t sensor, float m)
{
    size_t at = DISTANCE_PACK_NEAR;
    for (; at > 0 && m < apart_m[at - 1]; at--)
        if (at < DISTANCE_PACK_NEAR) {
            near[at] = near[at - 1];
            apart_m[at] = apart_m[at - 1];
        }
    if (at < DISTANCE_PACK_NEAR) {
        near[at] = sensor;
        apart_m[at] = m;
    }
}

/* Finds, for each sensor, the earlier sensors with the most similar distances, compared at some vertices all over the asset.
 * Packing predicts a sensor's distances from these. */
static void find_near(void *arg, size_t begin, size_t end)
{
    const struct packing *packing = arg;
    const struct distance_rows *rows = packing->rows;
    const float *sample[SAMPLES];
    for (size_t i = 0; i < SAMPLES; i++)
        sample[i] = rows->distances_m + rows->place_of[i * rows->vertex_count / SAMPLES] * rows->sensor_count;
    for (size_t s = begin; s < end; s++) {
        float apart_m[DISTANCE_PACK_NEAR];
        for (size_t k = 0; k < DISTANCE_PACK_NEAR; k++) {
            packing->near[s][k] = (uint16_t)s;
            apart_m[k] = INFINITY;
        }
        for (size_t other = 0; other < s; other++) {
            float sum = 0;
            for (size_t i = 0; i < SAMPLES; i++)
                sum += fabsf(fminf(sample[i][s], ASSET_DISTANCE_MOST_M) - fminf(sample[i][other], ASSET_DISTANCE_MOST_M));
            insert_near(packing->near[s], apart_m, (uint16_t)other, sum);
        }
    }
}

/* Replaces the padding of the last block of vertices by copies of the last vertex's distances, which pack into fewer bits. */
static void pad_block(uint16_t *codes, size_t sensor_count, size_t count)
{
    for (size_t s = 0; s < sensor_count; s++)
        for (size_t v = count; v < ASSET_DISTANCE_BLOCK; v++)
            codes[s * ASSET_DISTANCE_BLOCK + v] = codes[s * ASSET_DISTANCE_BLOCK + count - 1];
}

static void pack_blocks(void *arg, size_t begin, size_t end)
{
    struct packing *packing = arg;
    struct distance_rows *rows = packing->rows;
    uint16_t *codes = mem_try_array(rows->sensor_count, ASSET_DISTANCE_BLOCK * sizeof(*codes));
    uint8_t *room = mem_try_array(distance_pack_bound(rows->sensor_count), 1);
    for (size_t b = begin; codes && room && b < end && !packing->failed; b++) {
        size_t first = b * ASSET_DISTANCE_BLOCK, left = rows->vertex_count - first;
        size_t count = left < ASSET_DISTANCE_BLOCK ? left : ASSET_DISTANCE_BLOCK;
        turn_block(rows, first, count, codes);
        pad_block(codes, rows->sensor_count, count);
        size_t bytes = distance_pack(codes, rows->sensor_count, (const uint16_t(*)[DISTANCE_PACK_NEAR])packing->near, room);
        rows->packed[b] = bytes ? mem_try_array(bytes, 1) : NULL;
        if (rows->packed[b])
            memcpy(rows->packed[b], room, bytes);
        rows->offsets[b + 1] = bytes;
        packing->failed = packing->failed || !rows->packed[b];
    }
    packing->failed = packing->failed || !codes || !room;
    mem_free(codes);
    mem_free(room);
}

bool distance_rows_pack(struct distance_rows *rows, struct workers *workers)
{
    const size_t blocks = blocks_of(rows);
    if (rows->sensor_count < DISTANCE_PACK_MIN_SENSORS || rows->sensor_count > UINT16_MAX / 2 || rows->vertex_count == 0)
        return true;
    struct packing packing = { .rows = rows, .near = mem_try_array(rows->sensor_count, sizeof(*packing.near)) };
    rows->packed = mem_try_array(blocks, sizeof(*rows->packed));
    rows->offsets = mem_try_array(blocks + 1, sizeof(*rows->offsets));
    packing.failed = !packing.near || !rows->packed || !rows->offsets;
    if (!packing.failed) {
        workers_for(workers, rows->sensor_count, 16, find_near, &packing);
        workers_for(workers, blocks, 16, pack_blocks, &packing);
    }
    if (!packing.failed) {
        rows->offsets[0] = ((blocks + 1) * sizeof(*rows->offsets) + 15) / 16 * 16;
        for (size_t b = 0; b < blocks; b++)
            rows->offsets[b + 1] += rows->offsets[b];
        rows->packed_bytes = rows->offsets[blocks];
        if (rows->packed_bytes >= asset_distance_count(rows->sensor_count, rows->vertex_count) * sizeof(uint16_t))
            rows->packed_bytes = 0;
    }
    if (rows->packed_bytes) {
        mem_free(rows->distances_m);
        rows->distances_m = NULL;
    }
    mem_free(packing.near);
    return !packing.failed;
}

static int write_packed(const struct distance_rows *rows, int fd, off_t at)
{
    bool good = file_write(fd, rows->offsets, (blocks_of(rows) + 1) * sizeof(*rows->offsets), at);
    for (size_t b = 0; good && b < blocks_of(rows); b++)
        good = file_write(fd, rows->packed[b], rows->offsets[b + 1] - rows->offsets[b], at + (off_t)rows->offsets[b]);
    return good ? 0 : errno;
}

int distance_rows_write(const struct distance_rows *rows, struct workers *workers, int fd, off_t at)
{
    struct rows_block turn = { .rows = rows, .fd = fd, .at = at };
    if (rows->packed_bytes)
        return write_packed(rows, fd, at);
    workers_for(workers, blocks_of(rows), 16, turn_blocks, &turn);
    return turn.error;
}
