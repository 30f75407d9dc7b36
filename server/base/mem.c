/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Zeroed allocation with overflow checks; aborts when out of memory, because callers could do nothing sensible. */
#include "base/mem.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void out_of_memory(size_t bytes)
{
    fprintf(stderr, "plantcast: out of memory: cannot allocate %zu bytes\n", bytes);
    abort();
}

void *mem_try_array(size_t count, size_t bytes_each)
{
    size_t bytes;
    if (__builtin_mul_overflow(count, bytes_each, &bytes) || bytes > PTRDIFF_MAX)
        return NULL;
    return calloc(1, bytes ? bytes : 1);
}

void *mem_array(size_t count, size_t bytes_each)
{
    void *p = mem_try_array(count, bytes_each);
    if (!p)
        out_of_memory(count * bytes_each);
    return p;
}

void *mem_new(size_t bytes)
{
    return mem_array(1, bytes);
}

char *mem_strdup(const char *text)
{
    size_t bytes = strlen(text) + 1;
    return memcpy(mem_new(bytes), text, bytes);
}

char *mem_printf(const char *fmt, ...)
{
    va_list ap;
    char *text = NULL;
    va_start(ap, fmt);
    if (vasprintf(&text, fmt, ap) < 0)
        out_of_memory(0);
    va_end(ap);
    return text;
}

void mem_grow(void *array_ptr, size_t *capacity, size_t need, size_t bytes_each)
{
    void **array = array_ptr;
    if (need <= *capacity)
        return;
    size_t grown = *capacity ? *capacity : 8;
    while (grown < need)
        grown *= 2;
    char *p = reallocarray(*array, grown, bytes_each);
    if (!p)
        out_of_memory(grown * bytes_each);
    memset(p + *capacity * bytes_each, 0, (grown - *capacity) * bytes_each);
    *array = p;
    *capacity = grown;
}

void mem_free(void *p)
{
    free(p);
}
