/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Packs distance codes. Each code is predicted from the code eight vertices before, and from the change of a similar sensor's
   distance. A group's differences from the predictions are stored with as few bits as its largest difference needs. */
#include "protocol/distance_pack.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/distance_code.h"

#define BLOCK ASSET_DISTANCE_BLOCK
/* number of vertices processed at a time, with vector instructions: each code is predicted from the code LANES vertices before */
#define LANES 8u
#define GROUP 128u
#define GROUPS (BLOCK / GROUP)
/* value of `parent` in packed_row if a sensor's codes are predicted only from its own earlier codes, not from a similar
   sensor's */
#define NO_PARENT 0xffffu
#define PLAIN 0xfffeu     /* value of `parent` in packed_row: codes are not predicted, because some vertices have no path to the sensor */
#define SAMPLES 16u       /* number of vertices compared between two sensors' distances to find similar sensors */

/* How the codes of one sensor in a block are packed. parent: index of the similar sensor from which they are predicted,
   NO_PARENT or PLAIN; width: number of bits per code in each group. */
struct packed_row {
    uint16_t parent;
    uint8_t width[GROUPS]; /* bits per code */
};
_Static_assert(sizeof(struct packed_row) == 4, "as in ASSET.md");

static size_t rows_bytes(size_t sensor_count)
{
    return (sensor_count * sizeof(struct packed_row) + 15) / 16 * 16;
}

/* Returns the number of bytes of a row (one sensor's packed codes), not counting its first LANES codes. */
static size_t row_bytes(const struct packed_row *row)
{
    size_t bytes = 0;
    for (size_t g = 0; g < GROUPS; g++)
        bytes += row->width[g] * GROUP / 8;
    return bytes;
}

size_t distance_pack_bound(size_t sensor_count)
{
    return rows_bytes(sensor_count) + sensor_count * (LANES + BLOCK) * sizeof(uint16_t);
}

static uint16_t predict(float before_m, float parent_m, float parent_before_m)
{
    float m = before_m + (parent_m - parent_before_m);
    return asset_distance_code(m > 0 ? m : 0);
}

static void to_metres(const uint16_t *codes, float *out_m)
{
    for (size_t v = 0; v < BLOCK; v++)
        out_m[v] = asset_distance_of(codes[v]);
}

/* --- packing ---------------------------------------------------------------------------------------------------------------- */

static bool all_reached(const uint16_t *codes)
{
    bool reached = true;
    for (size_t v = 0; v < BLOCK; v++)
        reached &= codes[v] != ASSET_DISTANCE_NONE;
    return reached;
}

/* For each of SAMPLES vertices, writes how much the sensor's distance changes from that vertex to the one LANES further.
   Sensors with similar changes predict each other well. */
static void sample_slopes(const uint16_t *codes, float slope_m[SAMPLES])
{
    for (size_t i = 0; i < SAMPLES; i++) {
        size_t v = LANES + i * (BLOCK - LANES) / SAMPLES;
        slope_m[i] = asset_distance_of(codes[v]) - asset_distance_of(codes[v - LANES]);
    }
}

static float apart(const float a[SAMPLES], const float b[SAMPLES])
{
    float sum = 0;
    for (size_t i = 0; i < SAMPLES; i++)
        sum += fabsf(a[i] - b[i]);
    return sum;
}

static uint16_t choose_parent(const float (*slopes_m)[SAMPLES], const struct packed_row *rows, size_t sensor, const uint16_t *near)
{
    static const float level[SAMPLES];
    float least = apart(slopes_m[sensor], level);
    uint16_t parent = NO_PARENT;
    for (size_t i = 0; i < DISTANCE_PACK_NEAR; i++)
        if (near[i] < sensor && rows[near[i]].parent != PLAIN) {
            float error = apart(slopes_m[sensor], slopes_m[near[i]]);
            if (error < least) {
                least = error;
                parent = near[i];
            }
        }
    return parent;
}

/* Writes the differences between distance codes and their predictions, with the sign in the lowest bit. */
static void take_differences(const uint16_t *codes, const uint16_t *parent, uint16_t *out)
{
    float m[BLOCK], parent_m[BLOCK] = { 0 };
    to_metres(codes, m);
    if (parent)
        to_metres(parent, parent_m);
    memset(out, 0, LANES * sizeof(*out));
    for (size_t v = LANES; v < BLOCK; v++) {
        uint16_t off = (uint16_t)(codes[v] - predict(m[v - LANES], parent_m[v], parent_m[v - LANES]));
        out[v] = (uint16_t)(off << 1 ^ (off & 0x8000 ? 0xffff : 0));
    }
}

static uint8_t width_of(const uint16_t *group)
{
    unsigned all = 0;
    uint8_t width = 0;
    for (size_t i = 0; i < GROUP; i++)
        all |= group[i];
    for (; all; all >>= 1)
        width++;
    return width;
}

/* Packs a group of differences with `width` bits each. The words of the LANES lanes are interleaved; lane k contains the values
   k, k + LANES, k + 2 LANES, ... */
static uint8_t *pack_group(const uint16_t *group, unsigned width, uint8_t *out)
{
    uint16_t words[17 * LANES] = { 0 };
    for (unsigned step = 0; step < GROUP / LANES; step++) {
        unsigned word = step * width / 16, shift = step * width % 16;
        for (unsigned lane = 0; lane < LANES; lane++) {
            uint32_t bits = (uint32_t)group[step * LANES + lane] << shift;
            words[word * LANES + lane] |= (uint16_t)bits;
            words[(word + 1) * LANES + lane] |= (uint16_t)(bits >> 16);
        }
    }
    memcpy(out, words, width * GROUP / 8);
    return out + width * GROUP / 8;
}

size_t distance_pack(const uint16_t *codes, size_t sensor_count, const uint16_t (*near)[DISTANCE_PACK_NEAR], uint8_t *out)
{
    float(*slopes_m)[SAMPLES] = malloc(sensor_count * sizeof(*slopes_m));
    struct packed_row *rows = calloc(1, rows_bytes(sensor_count));
    uint8_t *to = out + rows_bytes(sensor_count);
    for (size_t s = 0; slopes_m && rows && s < sensor_count; s++) {
        const uint16_t *code = codes + s * BLOCK;
        uint16_t differences[BLOCK];
        const uint16_t *packed = differences;
        if (all_reached(code)) {
            sample_slopes(code, slopes_m[s]);
            rows[s].parent = choose_parent((const float(*)[SAMPLES])slopes_m, rows, s, near[s]);
            take_differences(code, rows[s].parent == NO_PARENT ? NULL : codes + rows[s].parent * BLOCK, differences);
        } else {
            rows[s].parent = PLAIN;
            packed = code;
        }
        memcpy(to, code, LANES * sizeof(*code));
        to += LANES * sizeof(*code);
        for (size_t g = 0; g < GROUPS; g++) {
            rows[s].width[g] = width_of(packed + g * GROUP);
            to = pack_group(packed + g * GROUP, rows[s].width[g], to);
        }
    }
    bool good = slopes_m && rows;
    if (good)
        memcpy(out, rows, rows_bytes(sensor_count));
    free(slopes_m);
    free(rows);
    return good ? (size_t)(to - out) : 0;
}

/* --- unpacking -------------------------------------------------------------------------------------------------------------- */

static struct packed_row row_at(const uint8_t *block, size_t sensor)
{
    struct packed_row row;
    memcpy(&row, block + sensor * sizeof(row), sizeof(row));
    return row;
}

bool distance_pack_good(const uint8_t *block, size_t bytes, size_t sensor_count)
{
    size_t need = rows_bytes(sensor_count);
    if (bytes < need)
        return false;
    for (size_t s = 0; s < sensor_count; s++) {
        struct packed_row row = row_at(block, s);
        if (row.parent < PLAIN && row.parent >= s)
            return false;
        for (size_t g = 0; g < GROUPS; g++)
            if (row.width[g] > 16)
                return false;
        need += LANES * sizeof(uint16_t) + row_bytes(&row);
    }
    return need == bytes;
}

static const uint8_t *unpack_group(const uint8_t *from, unsigned width, uint16_t *group)
{
    uint16_t words[17 * LANES] = { 0 };
    const uint32_t mask = (1u << width) - 1;
    memcpy(words, from, width * GROUP / 8);
    for (unsigned step = 0; step < GROUP / LANES; step++) {
        unsigned word = step * width / 16, shift = step * width % 16;
        for (unsigned lane = 0; lane < LANES; lane++) {
            uint32_t bits = words[word * LANES + lane] | (uint32_t)words[(word + 1) * LANES + lane] << 16;
            group[step * LANES + lane] = (uint16_t)(bits >> shift & mask);
        }
    }
    return from + width * GROUP / 8;
}

/* Turns differences between distance codes and their predictions into the codes, in place. The first LANES codes are known. */
static void add_predictions(uint16_t *codes, const uint16_t *parent)
{
    float m[BLOCK], parent_m[BLOCK] = { 0 };
    if (parent)
        to_metres(parent, parent_m);
    for (size_t v = 0; v < LANES; v++)
        m[v] = asset_distance_of(codes[v]);
    for (size_t v = LANES; v < BLOCK; v += LANES)
        for (size_t i = v; i < v + LANES; i++) {
            uint16_t off = (uint16_t)(codes[i] >> 1 ^ (codes[i] & 1 ? 0xffff : 0));
            codes[i] = (uint16_t)(predict(m[i - LANES], parent_m[i], parent_m[i - LANES]) + off);
            m[i] = asset_distance_of(codes[i]);
        }
}

void distance_unpack(const uint8_t *block, size_t sensor_count, uint16_t *codes)
{
    const uint8_t *from = block + rows_bytes(sensor_count);
    for (size_t s = 0; s < sensor_count; s++) {
        struct packed_row row = row_at(block, s);
        uint16_t *to = codes + s * BLOCK;
        const uint8_t *first = from;
        from += LANES * sizeof(*to);
        for (size_t g = 0; g < GROUPS; g++)
            from = unpack_group(from, row.width[g], to + g * GROUP);
        if (row.parent == PLAIN)
            continue;
        memcpy(to, first, LANES * sizeof(*to));
        add_predictions(to, row.parent == NO_PARENT ? NULL : codes + row.parent * BLOCK);
    }
}
