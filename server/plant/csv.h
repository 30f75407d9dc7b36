/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows of a CSV file (RFC 4180, and comma, semicolon or tab) with the place of every cell. Thread: one.
   The rows that plant_load makes tags of are exactly the rows that csv_next gives: the n-th row is tag n. */
#ifndef PLANT_CSV_H
#define PLANT_CSV_H
#include <stdbool.h>
#include <stddef.h>

#include "base/diag.h"

struct csv_cell {
    char *text;        /* unquoted; without surrounding blanks unless it was quoted */
    int line, column;  /* from 1; column counts characters */
};

struct csv_row {
    struct csv_cell *cells;
    size_t count, capacity;
};

struct csv { /* read only */
    char *path;
    struct diag *diag;
    char *bytes, *at;  /* the whole file, and what comes next in it */
    int line, column;  /* of `at` */
    char separator;
    struct csv_row header, row;
};

/* Reads the file and its header row. False: reported to diag, and csv needs no csv_close. path is copied; diag must outlive csv. */
bool csv_open(struct csv *csv, const char *path, struct diag *diag);
void csv_close(struct csv *csv);
/* The next row that is not blank. False: no more. What is wrong with quotes or the number of cells is reported. */
bool csv_next(struct csv *csv);
/* The separator that the first line with text has most of, outside quotes. */
char csv_separator(const char *text);
/* Index of the column with this name, upper or lower case, or -1. */
int csv_find(const struct csv *csv, const char *name);
/* The cell's text in the current row; "" where column is -1 or the row is shorter. Valid until csv_close. */
const char *csv_text(const struct csv *csv, int column);
/* Place of that cell; of the row's first cell where there is none. */
int csv_cell_line(const struct csv *csv, int column);
int csv_cell_column(const struct csv *csv, int column);
#define csv_error(csv, col, ...) diag_error((csv)->diag, (csv)->path, csv_cell_line(csv, col), csv_cell_column(csv, col), __VA_ARGS__)
#define csv_warning(csv, col, ...) diag_warning((csv)->diag, (csv)->path, csv_cell_line(csv, col), csv_cell_column(csv, col), __VA_ARGS__)

#endif
