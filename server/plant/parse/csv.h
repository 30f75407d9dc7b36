/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the rows of a CSV file (RFC 4180, separated by comma, semicolon or tab) with the line and column of each cell. In a tag
   list, the row that the n-th call of csv_next() returns describes tag n. Call from one thread only. */
#ifndef PLANT_PARSE_CSV_H
#define PLANT_PARSE_CSV_H
#include <stdbool.h>
#include <stddef.h>

#include "base/text/charset.h"
#include "base/text/diag.h"

struct csv_cell {
    char *text;       /* text of the cell without quotes; surrounding blanks are removed unless the cell was quoted */
    int line, column; /* position of the cell in the file, from 1; column counts characters */
};

struct csv_row {
    struct csv_cell *cells;
    size_t count, capacity;
};

struct csv { /* state of the CSV reader; callers may read the members but must not change them */
    char *path;
    struct diag *diag;
    char *bytes, *at; /* bytes: content of the file; at: the read position in it */
    int line, column; /* line and column of `at` */
    char separator;
    struct csv_row header, row;
};

/* Reads the file and its header row. Returns false after errors, which are added to diag; csv_close() is then not needed. The path is
   copied; diag must outlive the reader. */
bool csv_open(struct csv *csv, const char *path, struct diag *diag);
/* Opens a CSV file of another program, in any encoding, and reads its header row. encoding: name of the encoding, NULL: detected; *choice
   receives the encoding. */
bool csv_open_foreign(struct csv *csv, const char *path, const char *encoding, struct diag *diag, struct charset_choice *choice);
void csv_close(struct csv *csv);
/* Reads the next row that is not blank. Returns false after the last row. Rows with faulty quotes, or with a different number
   of cells than the header, are reported to diag. */
bool csv_next(struct csv *csv);
/* Returns the separator that occurs most often, outside quotes, in the first line that is not blank. */
char csv_separator(const char *text);
/* Returns the index of the column of that name, ignoring case, or -1. */
int csv_find(const struct csv *csv, const char *name);
/* Returns the text of a cell of the current row; "" if column is -1 or the row is shorter. Valid until csv_close(). */
const char *csv_text(const struct csv *csv, int column);
/* csv_cell_line() returns the line and csv_cell_column() the column of a cell of the current row. If the row is too short for
   that cell, they return the position of the row's first cell. */
int csv_cell_line(const struct csv *csv, int column);
int csv_cell_column(const struct csv *csv, int column);
#define csv_error(csv, col, ...) diag_error((csv)->diag, (csv)->path, csv_cell_line(csv, col), csv_cell_column(csv, col), __VA_ARGS__)
#define csv_warning(csv, col, ...) diag_warning((csv)->diag, (csv)->path, csv_cell_line(csv, col), csv_cell_column(csv, col), __VA_ARGS__)

#endif
