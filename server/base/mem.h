/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Memory allocation, always zeroed; free with mem_free(). The functions abort when out of memory, for small and fixed sizes, except
   mem_try_array(), which returns NULL: for sizes that come from a file, a client or a plant. Thread: any. */
#ifndef BASE_MEM_H
#define BASE_MEM_H
#include <stddef.h>

void *mem_new(size_t bytes);
void *mem_array(size_t count, size_t bytes_each);
char *mem_strdup(const char *text);
char *mem_printf(const char *fmt, ...) __attribute__((format(printf, 1, 2)));
/* Grows an array, `*(T **)array_ptr` with elements of bytes_each, to hold at least `need` elements. New elements are zeroed. */
void mem_grow(void *array_ptr, size_t *capacity, size_t need, size_t bytes_each);

/* Returns zeroed memory, or NULL if it is too large or out of memory. */
void *mem_try_array(size_t count, size_t bytes_each);
/* Frees what any of these returned; accepts NULL. */
void mem_free(void *p);

#endif
