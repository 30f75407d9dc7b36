/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Memory allocation, always zeroed; free with mem_free(). The functions abort when out of memory, and are for small or fixed
   sizes. For sizes that come from a file, a client or a plant, use mem_try_array(), which returns NULL instead. Call from any
   thread. */
#ifndef BASE_MEM_H
#define BASE_MEM_H
#include <stddef.h>

void *mem_new(size_t bytes);
void *mem_array(size_t count, size_t bytes_each);
char *mem_strdup(const char *text);
char *mem_printf(const char *fmt, ...) __attribute__((format(printf, 1, 2)));
/* Grows an array to hold at least `need` elements of bytes_each bytes. array_ptr is a `T **`. New elements are zeroed. */
void mem_grow(void *array_ptr, size_t *capacity, size_t need, size_t bytes_each);

/* Returns zeroed memory, or NULL if the size is too large or memory is exhausted. */
void *mem_try_array(size_t count, size_t bytes_each);
/* Frees memory returned by any function of this header; NULL is a no-op. */
void mem_free(void *p);

#endif
