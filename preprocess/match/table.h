/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A table of text cells from a CSV file or a spreadsheet. Reads more leniently than csv.h, because other programs write these
 * files: rows may differ in length. Call from any thread. */
#ifndef PREPROCESS_MATCH_TABLE_H
#define PREPROCESS_MATCH_TABLE_H
#include <stdbool.h>
#include <stddef.h>

struct table_row {
    char **cells; /* texts of the cells: UTF-8, trimmed; control characters are replaced by blanks */
    size_t count, capacity;
    int line; /* line number in the file, from 1; row number in a spreadsheet */
};

struct cell_table {         /* zero-initialise */
    struct table_row *rows; /* rows that are not blank */
    size_t count, capacity;
    size_t control; /* number of control characters replaced by blanks */
};

enum { TABLE_MAX_CELLS = 1000 };
#define TABLE_MAX_ROWS 1000000

/* Returns the character that probably separates the cells of a CSV text: the one of comma, semicolon, tab and bar that splits
 * most of the first lines into equally many cells. */
char table_separator(const char *text);
/* Appends the rows of a CSV text to the table. Returns false with the reason in why: too many rows, or an unterminated quote. */
bool table_read_csv(struct cell_table *table, const char *text, char separator, char *why, size_t why_bytes);
/* Callback that receives a sheet of a spreadsheet and its name. The callback owns the sheet and frees it with table_finish(). */
typedef void table_take_sheet(void *data, struct cell_table *sheet, const char *name);
/* Reads all non-empty sheets of a spreadsheet (Office Open XML, .xlsx) in workbook order, including hidden ones. Returns false with the
 * reason in why. */
bool table_read_xlsx(const char *path, table_take_sheet *take, void *data, char *why, size_t why_bytes);
/* Appends a cell to the row, trimmed and with control characters replaced by blanks. */
void table_add_cell(struct cell_table *table, struct table_row *row, const char *text, size_t length);
/* Appends a row to the table and takes ownership of its cells. Drops the row if all cells are blank. */
void table_add_row(struct cell_table *table, struct table_row *row);
/* Returns a cell, or "" if the row is too short or column is negative. */
const char *table_cell(const struct table_row *row, int column);
void table_row_finish(struct table_row *row);
void table_finish(struct cell_table *table);

#endif
