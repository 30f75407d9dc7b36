/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The header of a tag list: which column is what. Thread: any. */
#ifndef PREPROCESS_MATCH_TAG_HEADER_H
#define PREPROCESS_MATCH_TAG_HEADER_H
#include "preprocess/match/export_field.h"
#include "preprocess/match/table.h"

struct tag_header {
    int columns[EXPORT_FIELDS]; /* -1: none */
    int tag_type;               /* Ignition's, which tells folders */
    int span;                   /* of a range that begins at the scaled low end */
    int kind, specifier;        /* Studio 5000's: what a row is, and the element that a comment is about */
    const char *data_type;      /* of all rows below, or NULL */
};

/* Reads a row as a header. Returns the number of columns that are known. */
int tag_header_read(const struct table_row *row, struct tag_header *header);
/* Returns whether a cell is that word, as fold_key() leaves it. */
bool tag_header_has(const struct table_row *row, const char *word);

#endif
