/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Serialises arrays into bytes, for files that only this program reads, on machines of the same kind. Call from any thread. */
#ifndef BASE_FILES_PACK_H
#define BASE_FILES_PACK_H
#include <stdbool.h>

#include "base/text/text.h"

/* Appends the bytes of an array to the text `to`, preceded by the array's length. */
void pack_array(struct text *to, const void *array, size_t count, size_t bytes_each);

struct decompressor;

struct unpack { /* bytes of packed arrays that are not read yet; the caller owns them */
    const char *at;
    size_t left;
    bool bad;                        /* true: a read has failed, so all further reads fail too */
    struct decompressor *compressed; /* decompressor that supplies the bytes; NULL: the bytes are uncompressed, in memory at `at` */
};
/* Reads the next array; free with mem_free(). Returns NULL if the array is empty, has elements of another size, or does not fit
   into memory; from->bad stays false only for an empty array. */
void *unpack_array(struct unpack *from, size_t *count, size_t bytes_each);
/* Reads the next array, which must have exactly `count` elements, into the caller's memory. */
void unpack_into(struct unpack *from, void *to, size_t count, size_t bytes_each);

#endif
