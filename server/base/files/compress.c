/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compresses bytes in chunks. Compressed bytes consist of the number of uncompressed bytes (8 bytes), then for each chunk a header and a
   zstd frame. */
#include "base/files/compress.h"

#include <errno.h>
#include <stdint.h>
#include <string.h>
#include <zstd.h>

#include "base/mem.h"

#define CHUNK ((size_t)1 << 18)  /* uncompressed bytes of each chunk except the last one; larger chunks save less than 1 % more */
#define SAMPLE ((size_t)1 << 15) /* bytes at the start of a chunk that are compressed in each layout, to choose the best one */
#define LEVEL 1                  /* zstd compression level; level 3 would take twice the time for files 2 % smaller */

enum layout {
    LAYOUT_PLAIN,       /* bytes as they are */
    LAYOUT_PLANES,      /* the first bytes of all 32-bit words, then the second bytes of all words, and so on */
    LAYOUT_DIFFERENCES, /* as LAYOUT_PLANES, but for the differences between successive 32-bit words, with the sign in the lowest bit */
    LAYOUTS
};

struct chunk_head {
    uint32_t bytes;  /* size in bytes of the chunk's zstd frame, which follows this header */
    uint32_t layout; /* enum layout */
};

static size_t min_size(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* --- layouts ---------------------------------------------------------------------------------------------------------------------- */

static void to_planes(const uint8_t *from, size_t bytes, bool differences, uint8_t *to)
{
    const size_t words = bytes / 4;
    uint32_t before = 0;
    for (size_t i = 0; i < words; i++) {
        uint32_t word, stored;
        memcpy(&word, from + 4 * i, 4);
        stored = word;
        if (differences) {
            stored = word - before;
            stored = stored << 1 ^ (stored >> 31 ? UINT32_MAX : 0);
        }
        before = word;
        for (size_t plane = 0; plane < 4; plane++)
            to[plane * words + i] = (uint8_t)(stored >> 8 * plane);
    }
    memcpy(to + 4 * words, from + 4 * words, bytes % 4);
}

/* Restores words from their byte planes. Reassembling the words and adding up differences are two loops, because the compiler
   can vectorise only the first one. */
static void from_planes(const uint8_t *from, size_t bytes, bool differences, uint8_t *to)
{
    const size_t words = bytes / 4;
    uint32_t before = 0;
    for (size_t i = 0; i < words; i++) {
        const uint32_t word =
            from[i] | (uint32_t)from[words + i] << 8 | (uint32_t)from[2 * words + i] << 16 | (uint32_t)from[3 * words + i] << 24;
        memcpy(to + 4 * i, &word, 4);
    }
    for (size_t i = 0; i < words && differences; i++) {
        uint32_t stored;
        memcpy(&stored, to + 4 * i, 4);
        before += stored >> 1 ^ (stored & 1 ? UINT32_MAX : 0);
        memcpy(to + 4 * i, &before, 4);
    }
    memcpy(to + 4 * words, from + 4 * words, bytes % 4);
}

/* --- compression ------------------------------------------------------------------------------------------------------------------ */

struct compressor {
    ZSTD_CCtx *zstd;
    uint8_t *chunk, *laid_out; /* the chunk before compression, and the same bytes rearranged in the layout being compressed */
    uint8_t *out;              /* header and frame of a compressed chunk */
    size_t out_capacity;
};

/* Fills the chunk with the next bytes of the content, which is given in several parts. *part and *at: index of the present
   part, and position in that part. Returns the number of bytes; 0: the content has ended. */
static size_t fill_chunk(struct compressor *c, const struct atomic_file_part *parts, size_t part_count, size_t *part, size_t *at)
{
    size_t filled = 0;
    while (filled < CHUNK && *part < part_count) {
        const size_t bytes = min_size(CHUNK - filled, parts[*part].count - *at);
        if (bytes)
            memcpy(c->chunk + filled, (const uint8_t *)parts[*part].bytes + *at, bytes);
        filled += bytes;
        *at += bytes;
        if (*at == parts[*part].count) {
            (*part)++;
            *at = 0;
        }
    }
    return filled;
}

/* Compresses the first `bytes` bytes of the chunk to c->out, behind the header. Returns the compressed size, or an error code of zstd. */
static size_t compress_as(struct compressor *c, enum layout layout, size_t bytes)
{
    const size_t head = sizeof(struct chunk_head);
    if (layout != LAYOUT_PLAIN)
        to_planes(c->chunk, bytes, layout == LAYOUT_DIFFERENCES, c->laid_out);
    return ZSTD_compressCCtx(c->zstd, c->out + head, c->out_capacity - head, layout == LAYOUT_PLAIN ? c->chunk : c->laid_out, bytes, LEVEL);
}

/* Compresses a chunk with its header to c->out. Returns the size of both, or 0 if memory is short. */
static size_t compress_chunk(struct compressor *c, size_t bytes)
{
    struct chunk_head head = { 0 };
    size_t best = SIZE_MAX;
    for (enum layout layout = 0; layout < LAYOUTS; layout++) {
        const size_t size = compress_as(c, layout, min_size(bytes, SAMPLE));
        if (!ZSTD_isError(size) && size < best) {
            best = size;
            head.layout = layout;
        }
    }
    const size_t size = compress_as(c, head.layout, bytes);
    if (ZSTD_isError(size))
        return 0;
    head.bytes = (uint32_t)size;
    memcpy(c->out, &head, sizeof(head));
    return sizeof(head) + size;
}

int compress_parts(const struct atomic_file_part *parts, size_t part_count, int (*put)(void *arg, const void *bytes, size_t count),
                   void *arg)
{
    struct compressor c = { .zstd = ZSTD_createCCtx(), .chunk = mem_try_array(CHUNK, 1), .laid_out = mem_try_array(CHUNK, 1) };
    uint64_t count = 0;
    for (size_t i = 0; i < part_count; i++)
        count += parts[i].count;
    c.out_capacity = sizeof(struct chunk_head) + ZSTD_compressBound(CHUNK);
    c.out = mem_try_array(c.out_capacity, 1);
    int status = c.zstd && c.chunk && c.laid_out && c.out ? put(arg, &count, sizeof(count)) : -ENOMEM;
    size_t part = 0, at = 0, filled;
    while (status == 0 && (filled = fill_chunk(&c, parts, part_count, &part, &at)) > 0) {
        const size_t size = compress_chunk(&c, filled);
        status = size ? put(arg, c.out, size) : -ENOMEM;
    }
    ZSTD_freeCCtx(c.zstd);
    mem_free(c.chunk);
    mem_free(c.laid_out);
    mem_free(c.out);
    return status;
}

/* --- decompression ---------------------------------------------------------------------------------------------------------------- */

/* Reads the header of the chunk at *at, and moves *at behind the chunk. *frame receives the chunk's zstd frame. Returns false if the chunk
   is incomplete, or if its frame does not announce `count` uncompressed bytes. */
static bool next_chunk(const uint8_t *bytes, size_t size, size_t *at, size_t count, struct chunk_head *head, const uint8_t **frame)
{
    if (size - *at < sizeof(*head))
        return false;
    memcpy(head, bytes + *at, sizeof(*head));
    *at += sizeof(*head);
    *frame = bytes + *at;
    if (head->layout >= LAYOUTS || head->bytes > size - *at || ZSTD_getFrameContentSize(*frame, head->bytes) != count)
        return false;
    *at += head->bytes;
    return true;
}

size_t decompressed_size(const void *compressed, size_t bytes)
{
    struct chunk_head head;
    const uint8_t *frame;
    uint64_t count;
    size_t at = sizeof(count);
    if (bytes < sizeof(count))
        return SIZE_MAX;
    memcpy(&count, compressed, sizeof(count));
    for (uint64_t left = count; left > 0;) {
        const size_t chunk = left < CHUNK ? (size_t)left : CHUNK;
        if (!next_chunk(compressed, bytes, &at, chunk, &head, &frame))
            return SIZE_MAX;
        left -= chunk;
    }
    return at == bytes && count < SIZE_MAX ? (size_t)count : SIZE_MAX;
}

struct decompressor {
    const uint8_t *bytes; /* compressed bytes */
    size_t size, at;      /* size: number of compressed bytes in `bytes`; at: position of the next chunk among them */
    size_t left;          /* number of uncompressed bytes in the chunks from position `at` on */
    ZSTD_DCtx *zstd;
    uint8_t *planes;        /* a chunk in its layout */
    uint8_t *chunk;         /* bytes of a decompressed chunk of which the caller has read only a part so far */
    size_t filled, read_to; /* filled: number of bytes in `chunk`; read_to: number of these that the caller has read */
};

struct decompressor *decompressor_create(const void *compressed, size_t bytes)
{
    const size_t left = decompressed_size(compressed, bytes);
    struct decompressor *d = left == SIZE_MAX ? NULL : mem_try_array(1, sizeof(*d));
    if (!d)
        return NULL;
    *d = (struct decompressor){ .bytes = compressed, .size = bytes, .at = sizeof(uint64_t), .left = left, .zstd = ZSTD_createDCtx() };
    d->planes = mem_try_array(CHUNK, 1);
    d->chunk = mem_try_array(CHUNK, 1);
    if (!d->zstd || !d->planes || !d->chunk)
        decompressor_destroy(&d);
    return d;
}

void decompressor_destroy(struct decompressor **d)
{
    if (!*d)
        return;
    ZSTD_freeDCtx((*d)->zstd);
    mem_free((*d)->planes);
    mem_free((*d)->chunk);
    mem_free(*d);
    *d = NULL;
}

size_t decompressor_left(const struct decompressor *d)
{
    return d->left + d->filled - d->read_to;
}

/* Decompresses the next chunk, of `count` bytes. */
static bool decompress_chunk(struct decompressor *d, uint8_t *to, size_t count)
{
    struct chunk_head head;
    const uint8_t *frame;
    if (!next_chunk(d->bytes, d->size, &d->at, count, &head, &frame))
        return false;
    uint8_t *const into = head.layout == LAYOUT_PLAIN ? to : d->planes;
    if (ZSTD_decompressDCtx(d->zstd, into, count, frame, head.bytes) != count)
        return false;
    if (into == d->planes)
        from_planes(d->planes, count, head.layout == LAYOUT_DIFFERENCES, to);
    d->left -= count;
    return true;
}

bool decompressor_read(struct decompressor *d, void *to, size_t count)
{
    uint8_t *out = to;
    if (count > decompressor_left(d))
        return false;
    while (count > 0) {
        const size_t next = min_size(CHUNK, d->left), kept = min_size(count, d->filled - d->read_to);
        if (kept > 0) {
            memcpy(out, d->chunk + d->read_to, kept);
            d->read_to += kept;
            out += kept;
            count -= kept;
            /* the caller wants the whole chunk: decompresses it directly into the caller's memory, without a copy */
        } else if (count >= next) {
            if (!decompress_chunk(d, out, next))
                return false;
            out += next;
            count -= next;
        } else {
            if (!decompress_chunk(d, d->chunk, next))
                return false;
            d->filled = next;
            d->read_to = 0;
        }
    }
    return true;
}

void *decompress(const void *compressed, size_t bytes, size_t *count)
{
    struct decompressor *d = decompressor_create(compressed, bytes);
    *count = d ? decompressor_left(d) : 0;
    void *to = d ? mem_try_array(*count, 1) : NULL;
    if (to && !decompressor_read(d, to, *count)) {
        mem_free(to);
        to = NULL;
    }
    decompressor_destroy(&d);
    return to;
}
