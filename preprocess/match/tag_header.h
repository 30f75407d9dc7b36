/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recognises the columns of a tag list from its header. Call from any thread. */
#ifndef PREPROCESS_MATCH_TAG_HEADER_H
#define PREPROCESS_MATCH_TAG_HEADER_H
#include "preprocess/match/export_field.h"
#include "preprocess/match/table.h"

struct tag_header {
    int columns[EXPORT_FIELDS]; /* by field of a tag (export_field.h): index of its column; -1: none */
    int tag_type;               /* index of the column with Ignition's tag type, which marks folders; -1: none */
    int limit_states[4];        /* indices of the columns in which InTouch states whether LL, L, H and HH are on; -1: none */
    /* column indices in Studio 5000 exports. kind: kind of the row; specifier: element of a tag described by a comment row; -1: none */
    int kind, specifier;
    const char *data_type; /* data type of all tags in the rows after the header; NULL: unknown */
};

/* Reads a row as a header. Returns the number of recognised column names. */
int tag_header_read(const struct table_row *row, struct tag_header *header);
/* Returns whether a cell of the row equals the word after fold_key() of both. */
bool tag_header_has(const struct table_row *row, const char *word);

#endif
