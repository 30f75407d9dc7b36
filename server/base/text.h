/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A growing string, and a whole file as bytes. */
#ifndef BASE_TEXT_H
#define BASE_TEXT_H
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>

struct text { /* zero-initialise; .at is NULL until the first byte, then always ends in 0 */
    char *at;
    size_t length, capacity;
};

void text_add(struct text *text, const char *fmt, ...) __attribute__((format(printf, 2, 3)));
void text_add_v(struct text *text, const char *fmt, va_list ap) __attribute__((format(printf, 2, 0)));
void text_add_bytes(struct text *text, const void *bytes, size_t count);
void text_add_quoted(struct text *text, const char *cell); /* as CSV quotes: those inside twice */
/* A cell of a CSV file, quoted where one of `special` is in it. What a spreadsheet would take for a formula has a ' before it;
   text_cell_read: without. */
void text_add_cell(struct text *text, const char *cell, const char *special);
bool text_is_formula(const char *cell);
const char *text_cell_read(const char *cell);
void text_finish(struct text *text); /* frees; leaves it empty */

/* Reads a whole file of at most max_bytes; one 0 byte follows the content. NULL on failure: errno says why (EFBIG: too large).
   Free with mem_free. */
char *text_read_file(const char *path, size_t max_bytes, size_t *out_bytes);

#endif
