/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Codes of 16 bits for geodesic distances in asset files. A code has 5 bits of exponent and 11 bits of fraction, like a
   half-precision float without sign, but for larger numbers: the relative error is at most 2^-12 from 61 um to 131 km; below 61
   um the error is at most 15 nm. Call from any thread. */
#ifndef PROTOCOL_DISTANCE_CODE_H
#define PROTOCOL_DISTANCE_CODE_H
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define ASSET_DISTANCE_BLOCK 256u       /* number of vertices per block; the last block is padded (ASSET.md) */
#define ASSET_DISTANCE_NONE 0xffffu     /* infinity: not reachable */
#define ASSET_DISTANCE_MOST_M 130000.0f /* largest distance in metres that a code can represent; longer distances are stored as this one */

/* Returns the distance in metres that a code encodes; INFINITY for ASSET_DISTANCE_NONE. Always inlined into loops that are
   compiled for several types of processors. */
static inline __attribute__((always_inline)) float asset_distance_of(uint16_t code)
{
    uint32_t bits = (uint32_t)code << 12;
    float small;
    memcpy(&small, &bits, sizeof(small));
    return code == ASSET_DISTANCE_NONE ? INFINITY : small * 0x1p112f;
}

/* Returns the code nearest to a distance >= 0 in metres; ASSET_DISTANCE_NONE for INFINITY and NaN. */
static inline uint16_t asset_distance_code(float distance_m)
{
    float small = (distance_m < ASSET_DISTANCE_MOST_M ? distance_m : ASSET_DISTANCE_MOST_M) * 0x1p-112f;
    uint32_t bits;
    memcpy(&bits, &small, sizeof(bits));
    bits += 0x7ffu + (bits >> 12 & 1u); /* round half to even */
    return distance_m <= 0x1p127f ? (uint16_t)(bits >> 12) : ASSET_DISTANCE_NONE;
}

/* Returns the number of distance codes in an asset file: one per sensor and vertex, with padded blocks. */
static inline size_t asset_distance_count(size_t sensor_count, size_t vertex_count)
{
    return sensor_count * ((vertex_count + ASSET_DISTANCE_BLOCK - 1) / ASSET_DISTANCE_BLOCK) * ASSET_DISTANCE_BLOCK;
}

#endif
