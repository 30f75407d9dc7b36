/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Packs and unpacks arrays. An array is stored as its element count, its element size, and its bytes padded to a multiple of eight. */
#include "base/files/pack.h"

#include <stdint.h>
#include <string.h>

#include "base/files/compress.h"
#include "base/mem.h"

#define ALIGN 8

struct array_head {
    uint64_t count, bytes_each;
};

static size_t padding_of(size_t bytes)
{
    return (ALIGN - bytes % ALIGN) % ALIGN;
}

void pack_array(struct text *to, const void *array, size_t count, size_t bytes_each)
{
    const struct array_head head = { count, bytes_each };
    static const char zeros[ALIGN];
    text_add_bytes(to, &head, sizeof(head));
    if (count)
        text_add_bytes(to, array, count * bytes_each);
    text_add_bytes(to, zeros, padding_of(count * bytes_each));
}

static bool read_bytes(struct unpack *from, void *to, size_t count)
{
    from->bad |= count > from->left;
    if (from->bad || count == 0)
        return !from->bad;
    if (from->compressed) {
        from->bad = !decompressor_read(from->compressed, to, count);
    } else {
        memcpy(to, from->at, count);
        from->at += count;
    }
    from->left -= count;
    return !from->bad;
}

/* Reads the header of the next array. Returns its number of elements; 0 if the array is empty, has elements of another size, or the data
   ends. */
static size_t read_head(struct unpack *from, size_t bytes_each)
{
    struct array_head head = { 0 };
    read_bytes(from, &head, sizeof(head));
    from->bad |= head.bytes_each != bytes_each || head.count > from->left / bytes_each;
    return from->bad ? 0 : head.count;
}

/* Reads the elements of an array, and the padding to a multiple of eight bytes after them, which may be missing at the end of
   the data. */
static void read_elements(struct unpack *from, void *to, size_t count, size_t bytes_each)
{
    char padding[ALIGN];
    size_t bytes = padding_of(count * bytes_each);
    read_bytes(from, to, count * bytes_each);
    read_bytes(from, padding, bytes < from->left ? bytes : from->left);
}

void *unpack_array(struct unpack *from, size_t *count, size_t bytes_each)
{
    *count = read_head(from, bytes_each);
    void *array = *count ? mem_try_array(*count, bytes_each) : NULL;
    from->bad |= *count && !array;
    if (!from->bad)
        read_elements(from, array, *count, bytes_each);
    if (from->bad) {
        mem_free(array);
        array = NULL;
        *count = 0;
    }
    return array;
}

void unpack_into(struct unpack *from, void *to, size_t count, size_t bytes_each)
{
    from->bad |= read_head(from, bytes_each) != count;
    if (!from->bad)
        read_elements(from, to, count, bytes_each);
}
