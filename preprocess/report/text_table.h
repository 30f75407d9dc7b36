/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of text for a terminal: columns as wide as what is in them, numbers to the right. Thread: one. */
#ifndef PREPROCESS_REPORT_TEXT_TABLE_H
#define PREPROCESS_REPORT_TEXT_TABLE_H
#include <stdio.h>

#include "base/text.h"

struct text_table_column {
    const char *title;
    bool right; /* numbers */
};

struct text_table { /* columns belong to the caller; else zero-initialise */
    const struct text_table_column *columns;
    size_t column_count;
    char **cells; /* row by row */
    size_t cell_count, capacity;
};

/* The next cell; a row is full when it has as many as there are columns. */
void text_table_add(struct text_table *table, const char *fmt, ...) __attribute__((format(printf, 2, 3)));
/* With its titles, and without columns that are empty throughout; at most `rows` rows, then how many are left out. */
void text_table_print(const struct text_table *table, size_t rows, FILE *out);
void text_table_finish(struct text_table *table);

/* 62653 as 62,653. */
struct text_table_number {
    char text[32];
};
struct text_table_number text_table_number(unsigned long long number);

#endif
