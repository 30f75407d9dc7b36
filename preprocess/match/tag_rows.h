/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edits the rows of the tag list (tags.csv): adds the tags of an export and sets the equipment of existing ones. Call from one
   thread only. */
#ifndef PREPROCESS_MATCH_TAG_ROWS_H
#define PREPROCESS_MATCH_TAG_ROWS_H
#include "preprocess/match/decisions.h"
#include "preprocess/match/places.h"
#include "preprocess/match/table.h"
#include "preprocess/match/tag_names.h"

struct tag_rows {         /* zero-initialise */
    struct table_row *at; /* all rows of the tag list, existing and added; the first is the header */
    size_t count, capacity;
    int *by_name; /* indices of the rows that the tag list had before the run, sorted by the tag's name */
    size_t known; /* number of rows that the tag list had before the run, including the header */
    char separator;
    struct tag_rows *fresh; /* working memory of tag_rows_put(); NULL: not yet needed */
    /* For the result: names of tags whose row lacks a scaling, range or limits because those of the export cannot be used. types: tags
     * without a row, because their data type is not known or does not fit the address; differing: tags whose existing row differs from
     * the export */
    struct tag_names types, scalings, ranges, limits, differing;
};

struct tag_source { /* the source of the exported tags' values for the daemon */
    const char *id; /* id of the data source; NULL: the rows of the tag list get neither source nor address */
    bool modbus;    /* true: the source is Modbus; tags without a valid Modbus address are omitted */
    int address_base;
};

/* Reads the tag list (tags.csv). If it is missing or has only a header, the list gets the default header. Returns false with the reason in
 * why. */
bool tag_rows_read(struct tag_rows *rows, const char *path, char why[MATCH_WHY_BYTES]);
void tag_rows_finish(struct tag_rows *rows);

struct tag_row_input {
    const struct model_index *site;
    const struct export_tag *tag;
    const struct match *match;
    const struct decision *before; /* decision about the tag in the previous run; NULL: none */
    const struct place_proposal *place;
    const char *group; /* id of the tag's group; "": none */
    const struct tag_source *source;
};
/* Adds a tag to the list. If the list has it already, changes only its equipment, unless a person changed that, and a blank
 * address; the tag is added to `differing` if the export states other values. Returns the id of the row's asset ("": no
 * asset), valid until the next call; NULL if the tag was omitted from the list. */
const char *tag_rows_put(struct tag_rows *rows, const struct tag_row_input *input);
/* Appends the tag list as text. Omits columns added by this program that are blank in all rows. */
void tag_rows_write(const struct tag_rows *rows, struct text *out);

#endif
