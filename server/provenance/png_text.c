/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A chunk: length, type, data, CRC-32 of type and data; all numbers big-endian. */
#include "provenance/png_text.h"

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

/* Returns the bytes written; 0: it cannot be compressed. */
static size_t write_chunk(uint8_t *at, size_t room, const struct png_text *text)
{
    size_t keyword = strlen(text->keyword), begin = 8 + keyword + 2;
    uLongf length = room - begin - 4;
    memcpy(at + 4, "zTXt", 4);
    memcpy(at + 8, text->keyword, keyword + 1);
    at[8 + keyword + 1] = 0; /* deflate */
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

/* Of what follows keyword and method. */
static char *inflate_text(const uint8_t *at, size_t count, size_t max_bytes, size_t *out_length)
{
    char *text = mem_try_array(max_bytes + 1, 1);
    uLongf length = max_bytes;
    if (text && uncompress((Bytef *)text, &length, at, count) == Z_OK) {
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

/* A chunk of a PNG file, or the end. */
struct chunk {
    const uint8_t *type, *data;
    size_t length;
};

/* Moves *at to the next chunk. Returns false if there is none, or it is damaged. */
static bool next_chunk(const uint8_t *png, size_t count, size_t *at, struct chunk *out)
{
    if (count - *at < AROUND)
        return false;
    *out = (struct chunk){ .type = png + *at + 4, .data = png + *at + 8, .length = get_u32(png + *at) };
    if (out->length > count - *at - AROUND || get_u32(out->data + out->length) != crc32(0, out->type, (uInt)(4 + out->length)))
        return false;
    *at += AROUND + out->length;
    return true;
}

bool png_is_plain(const uint8_t *png, size_t count, char type[5])
{
    static const char *const plain[] = { "IHDR", "sRGB", "gAMA", "cHRM", "zTXt", "tEXt", "iTXt", "IDAT", "IEND" };
    struct chunk chunk;
    memset(type, 0, 5);
    for (size_t at = SIGNATURE; is_png(png, count) && next_chunk(png, count, &at, &chunk);) {
        bool known = false;
        for (size_t i = 0; i < sizeof(plain) / sizeof(*plain); i++)
            known |= memcmp(chunk.type, plain[i], 4) == 0;
        if (!known)
            memcpy(type, chunk.type, 4);
        if (!known || memcmp(chunk.type, "IEND", 4) == 0)
            return known && at == count;
    }
    return false;
}

char *png_text_find(const uint8_t *png, size_t count, const char *keyword, size_t max_bytes, size_t *out_length)
{
    struct chunk chunk, found = { .data = NULL };
    size_t before = strlen(keyword) + 2;
    for (size_t at = SIGNATURE; is_png(png, count) && next_chunk(png, count, &at, &chunk);)
        if (memcmp(chunk.type, "zTXt", 4) == 0 && has_keyword(chunk.data, chunk.length, keyword)) {
            if (found.data)
                return NULL;
            found = chunk;
        }
    return found.data ? inflate_text(found.data + before, found.length - before, max_bytes, out_length) : NULL;
}
