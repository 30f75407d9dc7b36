/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compresses rows of 64-bit numbers: groups their bytes by position in the row, then compresses them with zstd. Rows whose numbers differ
   little from those of a typical row (differences, XOR of successive values) become small. Thread: any. */
#ifndef HISTORY_COLUMNS_H
#define HISTORY_COLUMNS_H
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Returns the compressed rows, `width` numbers each; free with mem_free(). */
uint8_t *columns_pack(const uint64_t *rows, size_t width, size_t count, size_t *bytes);
/* Returns the rows, with their number in *count; free with mem_free(). Ignores bytes behind the compressed data. Returns NULL if the
   data is damaged or memory is short. */
uint64_t *columns_unpack(const void *data, size_t bytes, size_t width, size_t *count);

/* columns_of_double() converts a value to a number, columns_to_double() converts it back. The bits are rotated so that the mantissa of a
   32-bit value, which most devices send, fills whole bytes. Every NaN becomes the same NaN. */
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
