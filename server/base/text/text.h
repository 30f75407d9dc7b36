/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A growing string, cells of CSV files, and reading of whole files. Use each text in one thread only. */
#ifndef BASE_TEXT_TEXT_H
#define BASE_TEXT_TEXT_H
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>

struct text { /* zero-initialise; .at is NULL until the first byte is added, and always ends with a 0 byte afterwards */
    char *at;
    size_t length, capacity;
};

void text_add(struct text *text, const char *fmt, ...) __attribute__((format(printf, 2, 3)));
void text_add_v(struct text *text, const char *fmt, va_list ap) __attribute__((format(printf, 2, 0)));
void text_add_bytes(struct text *text, const void *bytes, size_t count);
void text_add_quoted(struct text *text, const char *cell); /* Appends a quoted CSV cell; inner quotes are doubled. */
/* Appends a CSV cell, quoted if it contains one of the characters `special`. Prefixes a ' to text that a spreadsheet would
   treat as a formula (text_is_formula()); text_cell_read() removes the ' again. */
void text_add_cell(struct text *text, const char *cell, const char *special);
bool text_is_formula(const char *cell);
const char *text_cell_read(const char *cell);
/* Appends text percent-encoded for use in a URL: characters other than the unreserved ones of RFC 3986 become %XX. */
void text_add_escaped(struct text *text, const char *part);
void text_finish(struct text *text); /* Frees the text and leaves an empty one. */

/* Returns a pointer to the last component of `path`, within the same string. */
const char *text_base_name(const char *path);
/* Returns whether two texts are equal except for their numbers. Such errors have the same cause: libcurl, for example, states elapsed
   milliseconds and received bytes. */
bool text_equal_but_numbers(const char *a, const char *b);
/* Reads a whole file of at most max_bytes. Returns its content, followed by a 0 byte (free with mem_free()), or NULL on
   failure, with errno (EFBIG: too large). */
char *text_read_file(const char *path, size_t max_bytes, size_t *out_bytes);

#endif
