/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text tables for a terminal: columns as wide as their contents, numbers aligned to the right. Call from one thread only. */
#ifndef PREPROCESS_REPORT_TEXT_TABLE_H
#define PREPROCESS_REPORT_TEXT_TABLE_H
#include <stdio.h>

#include "base/text/text.h"

struct text_table_column {
    const char *title;
    bool right; /* true: the column is right-aligned, as is usual for numbers */
};

struct text_table { /* A table under construction: zero-initialise it, then set `columns`, an array that the caller owns. */
    const struct text_table_column *columns;
    size_t column_count;
    char **cells; /* texts of the cells, row by row */
    size_t cell_count, capacity;
};

/* Formats the next cell. A row is complete after one cell per column. */
void text_table_add(struct text_table *table, const char *fmt, ...) __attribute__((format(printf, 2, 3)));
/* Prints the column titles, at most `rows` rows, and the number of rows left out. Omits columns without content. */
void text_table_print(const struct text_table *table, size_t rows, FILE *out);
/* Frees the cells. */
void text_table_finish(struct text_table *table);

/* A number formatted as text, returned by value. */
struct text_table_number {
    char text[32];
};
/* Returns the number with thousands separators: 62,653. */
struct text_table_number text_table_number(unsigned long long number);

#endif
