/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tag list (tags.csv) as rows: tags of an export are added to it, and those that are there are given their equipment. Thread: one. */
#ifndef PREPROCESS_MATCH_TAG_ROWS_H
#define PREPROCESS_MATCH_TAG_ROWS_H
#include "preprocess/match/decisions.h"
#include "preprocess/match/places.h"
#include "preprocess/match/table.h"

struct tag_rows {         /* zero-initialise */
    struct table_row *at; /* the first is the header */
    size_t count, capacity;
    int *by_name; /* rows that the file had, sorted */
    size_t known; /* how many those are, with the header */
    char separator;
};

struct tag_source { /* where tags of an export are read */
    const char *id; /* NULL: nothing is said of it, and no address is written */
    bool modbus;    /* tags without an address that it can have are left out */
    int address_base;
};

/* Reads the tag list; one that is not there, or has a header alone, is begun anew. Returns false with the reason. */
bool tag_rows_read(struct tag_rows *rows, const char *path, char why[MATCH_WHY_BYTES]);
void tag_rows_finish(struct tag_rows *rows);

struct tag_row_input {
    const struct model_index *site;
    const struct export_tag *tag;
    const struct match *match;
    const struct decision *before; /* of the last run, or NULL */
    const struct place_proposal *place;
    const char *group; /* id; "": none */
    const struct tag_source *source;
};
/* Adds a tag, or brings its row up to date, except where people changed it. Returns the id of the asset that the row has then, "" for none,
 * valid until the next call; NULL: it was left out. */
const char *tag_rows_put(struct tag_rows *rows, const struct tag_row_input *input);
/* Appends the list as text, without columns of our own that are blank in all rows. */
void tag_rows_write(const struct tag_rows *rows, struct text *out);

#endif
