/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compresses rows of 64-bit numbers: groups the bytes by column and position in the number, then compresses everything with
   zstd. The result is small if most numbers in a column are small, such as differences of successive times or XOR of successive
   values. Call from any thread. */
#ifndef HISTORY_COLUMNS_H
#define HISTORY_COLUMNS_H
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Compresses `count` rows of `width` numbers each. Returns the compressed data (free with mem_free()), and its length in *bytes. */
uint8_t *columns_pack(const uint64_t *rows, size_t width, size_t count, size_t *bytes);
/* Decompresses data of columns_pack(). Returns the rows (free with mem_free()), and their number in *count. Ignores bytes after
   the compressed data. Returns NULL if the data is damaged or memory is short. */
uint64_t *columns_unpack(const void *data, size_t bytes, size_t width, size_t *count);

/* columns_of_double() converts a reading's value to a 64-bit number for columns_pack(); columns_to_double() converts it back.
   The bits are rotated by 3, so that the mantissa of a value that a device sent as a 32-bit float fills whole bytes. All NaNs
   become the same NaN. */
static inline uint64_t columns_of_double(double value)
{
    uint64_t bits;
    value = isnan(value) ? NAN : value;
    memcpy(&bits, &value, sizeof(bits));
    return bits << 3 | bits >> 61;
}
static inline double columns_to_double(uint64_t rotated)
{
    uint64_t bits = rotated >> 3 | rotated << 61;
    double value;
    memcpy(&value, &bits, sizeof(value));
    return value;
}

#endif
