/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the tag list exported by a control system or OPC server, with columns of any names: Kepware CSV, Ignition JSON and CSV,
 * AVEVA InTouch DBDump and Galaxy dump, DeltaV and Experion style lists, plain CSV, spreadsheets. Call from any thread. */
#ifndef PREPROCESS_MATCH_TAG_EXPORT_H
#define PREPROCESS_MATCH_TAG_EXPORT_H
#include <stdbool.h>
#include <stddef.h>

#include "base/text/charset.h"
#include "base/text/text.h"
#include "preprocess/match/export_field.h"
#include "preprocess/match/tag_names.h"

struct export_tag {
    char *fields[EXPORT_FIELDS]; /* texts of the tag's fields, UTF-8; "": empty; NULL only while a reader fills the tag */
    int line;                    /* line number of the tag in the exported file; 0 for JSON */
};

struct tag_export {                 /* zero-initialise */
    const char *format;             /* name of the detected format (static) */
    struct charset_choice encoding; /* encoding of the exported file; name "": a spreadsheet */
    char separator;                 /* character that separates the columns of the exported file; 0: none */
    struct export_tag *tags;        /* tags in the order of the exported file; their names are unique (case-insensitive) */
    size_t count, capacity;
    size_t rows; /* number of rows that describe a tag, before merging duplicates */
    size_t same; /* number of rows omitted because they equal the first row with the same name */
    struct tag_names differing; /* rows omitted because they differ from the first row with the same name */
    /* nameless: number of rows omitted because they have no name; control: number of control characters; damaged: number of
     * undecodable characters */
    size_t nameless, control, damaged;
    struct text remarks; /* further remarks for the user about the exported file, one per line */
    /* number of tags whose folder path was prefixed to their name, because tags of other folders have the same name */
    size_t renamed;
};

/* Reads an exported tag list. encoding: a name known to charset_resolve(); NULL: detect it with charset_find(). Returns false
 * with the reason in why and an empty list. */
bool tag_export_read(struct tag_export *list, const char *path, const char *encoding, char *why, size_t why_bytes);
void tag_export_finish(struct tag_export *list);

/* Appends an empty tag to the list; for the file format readers. Returns a pointer that is valid until the next call. */
struct export_tag *tag_export_add(struct tag_export *list, int line);
/* Sets a field of a tag to a copy of text. Does nothing if the field already has a value or text is blank. */
void export_tag_set(struct export_tag *tag, enum export_field field, const char *text);
/* Reads an export of tags from Ignition (JSON). Returns false with the reason in why. */
bool tag_export_read_json(struct tag_export *list, const char *text, size_t length, char *why, size_t why_bytes);
/* Replaces the texts of ranges and limits by numbers with a decimal point. Adds remarks about texts that are not numbers, and about
 * numbers in which a comma or dot may separate thousands. */
void tag_export_read_numbers(struct tag_export *list);
/* Merges the list's duplicate tags, so that names are unique. */
void tag_export_join(struct tag_export *list);

#endif
