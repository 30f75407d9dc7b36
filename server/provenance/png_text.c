/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes and reads chunks of PNG files. A chunk has a length, a type, data, and the CRC-32 of type and data; all numbers are big-endian. */
#include "provenance/png_text.h"

#include <stdio.h>
#include <string.h>
#include <zlib.h>

#include "base/mem.h"

enum { SIGNATURE = 8, HEADER = SIGNATURE + 25, AROUND = 12, KEYWORD_MAX = 79, FAST = 1 };
static const uint8_t signature[SIGNATURE] = { 0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n' };

static void put_u32(uint8_t *at, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        at[i] = (uint8_t)(value >> (24 - 8 * i));
}

static uint32_t get_u32(const uint8_t *at)
{
    return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

/* Writes a chunk with compressed text (zTXt). Returns the number of bytes written; 0: compression failed. */
static size_t write_chunk(uint8_t *at, size_t room, const struct png_text *text)
{
    size_t keyword = strlen(text->keyword), begin = 8 + keyword + 2;
    uLongf length = room - begin - 4;
    memcpy(at + 4, "zTXt", 4);
    memcpy(at + 8, text->keyword, keyword + 1);
    at[8 + keyword + 1] = 0; /* compression method 0: deflate */
    if (compress2(at + begin, &length, (const Bytef *)text->text, text->length, FAST) != Z_OK)
        return 0;
    size_t data = keyword + 2 + length;
    put_u32(at, (uint32_t)data);
    put_u32(at + 8 + data, (uint32_t)crc32(0, at + 4, (uInt)(4 + data)));
    return AROUND + data;
}

static bool is_png(const uint8_t *png, size_t count)
{
    return count >= HEADER && memcmp(png, signature, SIGNATURE) == 0;
}

uint8_t *png_text_add(const uint8_t *png, size_t count, const struct png_text *texts, int text_count, size_t *out_count)
{
    size_t room = count;
    for (int i = 0; i < text_count; i++)
        room += AROUND + KEYWORD_MAX + 2 + compressBound(texts[i].length);
    uint8_t *out = is_png(png, count) ? mem_try_array(room, 1) : NULL;
    if (!out)
        return NULL;
    memcpy(out, png, HEADER);
    size_t used = HEADER;
    for (int i = 0; i < text_count; i++) {
        size_t chunk = write_chunk(out + used, AROUND + KEYWORD_MAX + 2 + compressBound(texts[i].length), &texts[i]);
        if (!chunk) {
            mem_free(out);
            return NULL;
        }
        used += chunk;
    }
    memcpy(out + used, png + HEADER, count - HEADER);
    *out_count = used + count - HEADER;
    return out;
}

/* Decompresses the text of a zTXt chunk. `at`: the chunk's data after the keyword and the compression method. */
static char *inflate_text(const uint8_t *at, size_t count, size_t max_bytes, size_t *out_length)
{
    char *text = mem_try_array(max_bytes + 1, 1);
    uLongf length = max_bytes;
    uLong taken = count;
    if (text && uncompress2((Bytef *)text, &length, at, &taken) == Z_OK && taken == count) {
        text[length] = 0;
        *out_length = length;
        return text;
    }
    mem_free(text);
    return NULL;
}

static bool has_keyword(const uint8_t *data, size_t length, const char *keyword)
{
    size_t n = strlen(keyword);
    return length > n + 2 && memcmp(data, keyword, n + 1) == 0 && data[n + 1] == 0;
}

/* one chunk of a PNG file: its type and the position of its data */
struct png_chunk {
    const uint8_t *type, *data;
    size_t length;
};

/* Reads the chunk at *at and moves *at to the next one. Returns false at the end of the file or if the chunk is damaged. */
static bool next_chunk(const uint8_t *png, size_t count, size_t *at, struct png_chunk *out)
{
    if (count - *at < AROUND)
        return false;
    *out = (struct png_chunk){ .type = png + *at + 4, .data = png + *at + 8, .length = get_u32(png + *at) };
    if (out->length > count - *at - AROUND || get_u32(out->data + out->length) != crc32(0, out->type, (uInt)(4 + out->length)))
        return false;
    *at += AROUND + out->length;
    return true;
}

/* A chunk type that our PNG writer emits. `bytes`: the chunk's exact data; NULL: any data of at least one byte. */
struct plain_chunk {
    char type[5];
    bool required, repeats;
    const char *bytes;
    size_t length;
};

/* sRGB must have perceptual intent; gAMA and cHRM must have the values of sRGB (PNG, third edition, 11.3.2.5). Of these three,
   our writer emits only sRGB. */
static const struct plain_chunk plain[] = {
    { "sRGB", true, false, "\0", 1 },
    { "gAMA", false, false, "\0\0\xb1\x8f", 4 },
    { "cHRM", false, false, "\0\0\x7a\x26\0\0\x80\x84\0\0\xfa\0\0\0\x80\xe8\0\0\x75\x30\0\0\xea\x60\0\0\x3a\x98\0\0\x17\x70", 32 },
    { "IDAT", true, true, NULL, 0 },
    { "IEND", true, false, "", 0 },
};
enum { PLAIN_CHUNKS = sizeof(plain) / sizeof(*plain) };

#define FAIL(...) (snprintf(why, PNG_PLAIN_WHY_BYTES, __VA_ARGS__), false)

/* Returns true if the header says 8-bit RGB, not interlaced: viewers may alter the pixel values of other formats. */
static bool is_plain_header(const struct png_chunk *chunk, char why[PNG_PLAIN_WHY_BYTES])
{
    static const uint8_t format[] = { 8, 2, 0, 0, 0 };
    bool is_header = memcmp(chunk->type, "IHDR", 4) == 0 && chunk->length == 13;
    if (!is_header)
        return FAIL("this is not a PNG picture of Plantcast: the first chunk is not IHDR");
    return memcmp(chunk->data + 8, format, sizeof(format)) == 0 ||
           FAIL("this is not a picture signed by Plantcast: the PNG file has another format than 8 bits of red, green and blue");
}

/* Returns the index of the chunk's type in `plain`, the table of chunk types that our writer emits; PLAIN_CHUNKS: not in the table. */
static int plain_row(const struct png_chunk *chunk)
{
    int row = 0;
    while (row < PLAIN_CHUNKS && memcmp(chunk->type, plain[row].type, 4) != 0)
        row++;
    return row;
}

static char printable(uint8_t byte)
{
    return byte > ' ' && byte < 0x7f ? (char)byte : '?';
}

static bool takes_plain_chunk(const struct png_chunk *chunk, int *next, char why[PNG_PLAIN_WHY_BYTES])
{
    int row = plain_row(chunk);
    if (row == PLAIN_CHUNKS)
        return FAIL("unexpected PNG chunk %c%c%c%c: the picture was changed, or not signed by Plantcast", printable(chunk->type[0]),
                    printable(chunk->type[1]), printable(chunk->type[2]), printable(chunk->type[3]));
    bool again = row + 1 == *next && plain[row].repeats;
    if (row < *next && !again)
        return FAIL("the picture was changed, or not signed by Plantcast: PNG chunk %.4s occurs twice or in an unusual place",
                    plain[row].type);
    for (int i = *next; i < row; i++)
        if (plain[i].required)
            return FAIL("the picture was changed, or not signed by Plantcast: PNG chunk %.4s is missing or in an unusual place",
                        plain[i].type);
    if (plain[row].bytes && (chunk->length != plain[row].length || memcmp(chunk->data, plain[row].bytes, chunk->length) != 0))
        return FAIL(
            "the picture was changed, or not signed by Plantcast: the contents of PNG chunk %.4s differ from those that Plantcast writes",
            plain[row].type);
    *next = row + 1;
    return true;
}

bool png_is_plain(const uint8_t *png, size_t count, const char *const *keywords, int keyword_count, char why[PNG_PLAIN_WHY_BYTES])
{
    struct png_chunk chunk;
    size_t at = SIGNATURE;
    int texts = 0, next = 0;
    if (!is_png(png, count) || !next_chunk(png, count, &at, &chunk))
        return FAIL("the picture is damaged: the PNG file is incomplete");
    if (!is_plain_header(&chunk, why))
        return false;
    while (next_chunk(png, count, &at, &chunk)) {
        bool is_text = memcmp(chunk.type, "zTXt", 4) == 0;
        if (is_text && (texts == keyword_count || next > 0 || !has_keyword(chunk.data, chunk.length, keywords[texts])))
            return FAIL("the picture was changed, or not signed by Plantcast: PNG chunk zTXt occurs twice or in an unusual place");
        texts += is_text;
        if (!is_text && texts < keyword_count)
            return FAIL("the picture is not signed: the PNG file has no text chunk %s directly after its header", keywords[texts]);
        if (!is_text && !takes_plain_chunk(&chunk, &next, why))
            return false;
        if (next == PLAIN_CHUNKS)
            return at == count || FAIL("the picture was changed: the PNG file has %zu bytes after its last chunk", count - at);
    }
    return FAIL("the picture is damaged: the PNG file is truncated or has wrong checksums");
}

char *png_text_find(const uint8_t *png, size_t count, const char *keyword, size_t max_bytes, size_t *out_length)
{
    struct png_chunk chunk, found = { .data = NULL };
    size_t before = strlen(keyword) + 2;
    for (size_t at = SIGNATURE; is_png(png, count) && next_chunk(png, count, &at, &chunk);)
        if (memcmp(chunk.type, "zTXt", 4) == 0 && has_keyword(chunk.data, chunk.length, keyword)) {
            if (found.data)
                return NULL;
            found = chunk;
        }
    return found.data ? inflate_text(found.data + before, found.length - before, max_bytes, out_length) : NULL;
}
