/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the columns of the tag list by name and reads the cells of its current row. Only for the files of this folder. */
#ifndef PLANT_TAGS_TAG_COLUMNS_H
#define PLANT_TAGS_TAG_COLUMNS_H
#include <stdbool.h>
#include <stddef.h>

#include "plant/parse/csv.h"

enum tag_column {
    /* Kepware's */
    COL_NAME, COL_ADDRESS, COL_DATA_TYPE, COL_SCAN_RATE, COL_SCALING, COL_RAW_LOW, COL_RAW_HIGH, COL_SCALED_LOW, COL_SCALED_HIGH,
    COL_ENG_UNITS, COL_NEGATE, COL_DESCRIPTION, COL_CLAMP_LOW, COL_CLAMP_HIGH,
    /* columns of tag lists that the program Kepware exports; they are accepted and ignored */
    COL_RESPECT_DATA_TYPE, COL_CLIENT_ACCESS, COL_SCALED_DATA_TYPE,
    /* ours */
    COL_SOURCE, COL_GROUP, COL_ASSET, COL_NODE, COL_X, COL_Y, COL_Z, COL_STRENGTH, COL_DECAY, COL_BYTE_ORDER, COL_STALE,
    COL_LL, COL_L, COL_H, COL_HH, COL_NE43, COL_OPEN_CIRCUIT, COL_QUALITY_TAG,
    COL_FLATLINE, COL_DEADBAND, COL_ALARM_DEADBAND, COL_ON_DELAY, COL_OFF_DELAY, COL_PRIORITY, COL_LATCH, COL_SUPPRESSED_BY, COL_MIRRORS,
    COL_PLACE, COL_DIRECTION, COL_OPC_DEADBAND,
    COL_COUNT
};

struct tag_columns {
    struct csv csv;
    int at[COL_COUNT]; /* by column: index of the column in the file; -1: the file lacks the column */
};

/* Opens the tag list and finds its columns; unknown and duplicate columns are reported. Returns false if the list cannot be read
   (reported). */
bool tag_columns_open(struct tag_columns *columns, const char *path, struct diag *diag);
void tag_columns_need(struct tag_columns *columns, enum tag_column column); /* Reports an error if the tag list lacks the column. */
const char *tag_column_name(enum tag_column column);

/* Returns the text of a cell of the current row; "" if the list has no such column. */
const char *cell_text(const struct tag_columns *columns, enum tag_column column);
/* Returns whether the cell is not blank; false if the list has no such column. */
bool cell_given(const struct tag_columns *columns, enum tag_column column);
/* Reads a number in [low, high] (both 0: any finite number). Returns false, with *out unchanged, if the cell is blank or wrong
   (reported). */
bool cell_number(struct tag_columns *columns, enum tag_column column, double low, double high, double *out);
bool cell_flag(struct tag_columns *columns, enum tag_column column); /* Reads a flag: 1, true, yes; 0, false, no or blank. */
/* Returns the index of the item (asset, group or source) that the cell names, or -1 if the cell is blank or the name unknown (reported).
   `things`: records of all such items, each beginning with its id. */
int cell_reference(struct tag_columns *columns, enum tag_column column, const char *what, const void *things, size_t count, size_t stride);
#define cell_error(columns, c, ...) csv_error(&(columns)->csv, (columns)->at[c], __VA_ARGS__)
#define cell_warning(columns, c, ...) csv_warning(&(columns)->csv, (columns)->at[c], __VA_ARGS__)

#endif
