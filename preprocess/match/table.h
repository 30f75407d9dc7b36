/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A table of text cells, out of a CSV file or a spreadsheet. It is more lenient than csv.h, since other programs wrote it: rows may
 * have any number of cells. Thread: any. */
#ifndef PREPROCESS_MATCH_TABLE_H
#define PREPROCESS_MATCH_TABLE_H
#include <stdbool.h>
#include <stddef.h>

struct table_row {
    char **cells; /* UTF-8, trimmed; control characters are blanks */
    size_t count, capacity;
    int line; /* of the file, from 1; of a spreadsheet its row */
};

struct cell_table {         /* zero-initialise */
    struct table_row *rows; /* those that are not blank */
    size_t count, capacity;
    size_t control; /* control characters that became blanks */
};

enum { TABLE_MAX_CELLS = 1000 };
#define TABLE_MAX_ROWS 1000000

/* Returns the separator: comma, semicolon, tab or bar, whichever divides most of the first lines into the same number of cells. */
char table_separator(const char *text);
/* Appends the rows of a CSV text. Returns false with the reason in `why`: too many rows, or a quote that does not end. */
bool table_read_csv(struct cell_table *table, const char *text, char separator, char *why, size_t why_bytes);
/* Takes the rows of a sheet and its name: the sheet is the callee's to finish. */
typedef void table_take_sheet(void *data, struct cell_table *sheet, const char *name);
/* Reads the sheets of a spreadsheet (Office Open XML, .xlsx) that are not empty, in the order of the workbook, hidden ones too. Returns
   false with the reason. */
bool table_read_xlsx(const char *path, table_take_sheet *take, void *data, char *why, size_t why_bytes);
/* Appends a cell to the row, trimmed and without control characters. */
void table_add_cell(struct cell_table *table, struct table_row *row, const char *text, size_t length);
/* Appends a row, unless it is blank, and takes its cells. */
void table_add_row(struct cell_table *table, struct table_row *row);
/* Returns a cell, "" where the row ends before it or column is negative. */
const char *table_cell(const struct table_row *row, int column);
void table_row_finish(struct table_row *row);
void table_finish(struct cell_table *table);

#endif
