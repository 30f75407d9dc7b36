/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compresses and decompresses rows of 64-bit numbers with zstd, grouped by column and by byte. */
#include "history/columns.h"

#include <zstd.h>

#include "base/mem.h"

/* Compression levels of zstd. An input of up to SMALL_BYTES, such as one second of readings of several hundred tags, gets
   SMALL_LEVEL, which may take a millisecond. A larger input gets LEVEL, which is faster. */
enum { SMALL_BYTES = 1 << 16, SMALL_LEVEL = 9, LEVEL = 3 };
static const unsigned long long BYTES_MAX = 1ULL << 30;

uint8_t *columns_pack(const uint64_t *rows, size_t width, size_t count, size_t *bytes)
{
    size_t words = width * count, bound = ZSTD_compressBound(words * 8);
    uint8_t *planes = mem_array(words + 1, 8), *packed = mem_array(bound, 1);
    for (size_t column = 0; column < width; column++)
        for (size_t i = 0; i < count; i++)
            for (size_t byte = 0; byte < 8; byte++)
                planes[(column * 8 + byte) * count + i] = (uint8_t)(rows[i * width + column] >> (8 * byte));
    /* ignores errors of ZSTD_compress(): an output buffer of ZSTD_compressBound() bytes is always large enough */
    *bytes = ZSTD_compress(packed, bound, planes, words * 8, words * 8 <= SMALL_BYTES ? SMALL_LEVEL : LEVEL);
    mem_free(planes);
    return packed;
}

static void join_planes(const uint8_t *planes, size_t width, size_t count, uint64_t *rows)
{
    for (size_t column = 0; column < width; column++) {
        const uint8_t *at = planes + column * 8 * count;
        for (size_t i = 0; i < count; i++, at++) {
            uint64_t word = 0;
            for (size_t byte = 0; byte < 8; byte++)
                word |= (uint64_t)at[byte * count] << (8 * byte);
            rows[i * width + column] = word;
        }
    }
}

uint64_t *columns_unpack(const void *data, size_t bytes, size_t width, size_t *count)
{
    unsigned long long whole = ZSTD_getFrameContentSize(data, bytes);
    size_t used = ZSTD_findFrameCompressedSize(data, bytes);
    if (whole > BYTES_MAX || whole % (8 * width) != 0 || ZSTD_isError(used))
        return NULL;
    *count = (size_t)whole / (8 * width);
    uint8_t *planes = mem_try_array((size_t)whole + 1, 1);
    uint64_t *rows = mem_try_array(width * *count + 1, sizeof(*rows));
    if (planes && rows && ZSTD_decompress(planes, (size_t)whole, data, used) == whole) {
        join_planes(planes, width, *count, rows);
    } else {
        mem_free(rows);
        rows = NULL;
    }
    mem_free(planes);
    return rows;
}
