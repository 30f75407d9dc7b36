/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Allocation. mem_new and friends abort when out of memory: for small, fixed things.
   mem_try_* may return NULL: for what a file, a peer or a plant sizes. Everything is zeroed. Free with mem_free. */
#ifndef BASE_MEM_H
#define BASE_MEM_H
#include <stddef.h>

void *mem_new(size_t bytes);
void *mem_array(size_t count, size_t bytes_each);
char *mem_strdup(const char *text);
char *mem_printf(const char *fmt, ...) __attribute__((format(printf, 1, 2)));
/* Grows `*array` (of `bytes_each`) so that it holds at least `need`; new space is zeroed; aborts when out of memory. */
void mem_grow(void *array_ptr, size_t *capacity, size_t need, size_t bytes_each);

void *mem_try_array(size_t count, size_t bytes_each); /* NULL: too large or out of memory */
void mem_free(void *p);

#endif
