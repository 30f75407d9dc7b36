/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Arrays one after another in bytes, for files that only this program on this kind of machine reads again. Thread: any. */
#ifndef BASE_PACK_H
#define BASE_PACK_H
#include <stdbool.h>

#include "base/text.h"

void pack_array(struct text *to, const void *array, size_t count, size_t bytes_each);

struct unpack { /* bytes that are not yet read; they belong to the caller */
    const char *at;
    size_t left;
    bool bad; /* something was asked for that is not there; from then on nothing is */
};
/* Free with mem_free. NULL where it is empty, and where it is not there: no such array of elements of that size, or out of memory. */
void *unpack_array(struct unpack *from, size_t *count, size_t bytes_each);
/* The same into what the caller has, which must be as long. */
void unpack_into(struct unpack *from, void *to, size_t count, size_t bytes_each);

#endif
