/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Packs and unpacks arrays. An array is stored as its element count, its element size, and its bytes padded to a multiple of eight. */
#include "base/files/pack.h"

#include <stdint.h>
#include <string.h>

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

/* Returns the bytes of the next array; *count receives its number of elements. NULL: the array is empty, its elements have
   another size, or the data is truncated. */
static const char *take(struct unpack *from, size_t *count, size_t bytes_each)
{
    struct array_head head = { 0 };
    if (!from->bad && from->left >= sizeof(head))
        memcpy(&head, from->at, sizeof(head));
    from->bad |= head.bytes_each != bytes_each || head.count > (from->left - sizeof(head)) / bytes_each;
    *count = 0;
    if (from->bad)
        return NULL;
    const char *bytes = from->at + sizeof(head);
    size_t whole = head.count * bytes_each + padding_of(head.count * bytes_each), left = from->left - sizeof(head);
    *count = head.count;
    whole = whole < left ? whole : left;
    from->at = bytes + whole;
    from->left = left - whole;
    return bytes;
}

void *unpack_array(struct unpack *from, size_t *count, size_t bytes_each)
{
    const char *bytes = take(from, count, bytes_each);
    void *array = *count ? mem_try_array(*count, bytes_each) : NULL;
    if (array)
        memcpy(array, bytes, *count * bytes_each);
    from->bad |= *count && !array;
    return array;
}

void unpack_into(struct unpack *from, void *to, size_t count, size_t bytes_each)
{
    size_t there;
    const char *bytes = take(from, &there, bytes_each);
    from->bad |= there != count;
    if (!from->bad && count)
        memcpy(to, bytes, count * bytes_each);
}
