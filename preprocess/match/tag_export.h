/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the tag list that a control system or an OPC server exports, whatever its columns are called: Kepware CSV, Ignition JSON and CSV,
 * InTouch DBDump and Galaxy dump (AVEVA), lists as DeltaV and Experion give them, plain CSV, spreadsheets. Thread: any. */
#ifndef PREPROCESS_MATCH_TAG_EXPORT_H
#define PREPROCESS_MATCH_TAG_EXPORT_H
#include <stdbool.h>
#include <stddef.h>

#include "base/text/charset.h"
#include "base/text/text.h"
#include "preprocess/match/export_field.h"

struct export_tag {
    char *fields[EXPORT_FIELDS]; /* UTF-8; "": none */
    int line;                    /* of the file; 0: JSON, which has none */
};

struct tag_export {                /* zero-initialise */
    const char *format;            /* static */
    struct charset_choice encoding; /* name "": a spreadsheet */
    char separator;                /* 0: none */
    struct export_tag *tags;       /* by name unique, upper and lower case taken as one; in the order of the file */
    size_t count, capacity;
    size_t rows;                       /* tags before repeated ones were joined */
    size_t same, differing;            /* repeated rows that say the same as the first of their name, and that do not: left out */
    char *differing_lines;             /* the first of those: "TT-101 (lines 5 and 80), ..."; NULL: none */
    size_t nameless, control, damaged; /* rows without a name, left out; control characters; characters that could not be decoded */
    struct text remarks;               /* other things that a person should know, a line each */
    size_t renamed;                    /* tags with one name in several folders, which now have their path in front */
};

/* Reads a file, of an encoding that charset_resolve() knows; NULL: charset_find() decides. Returns false with the reason in `why`; then the
   list is empty. */
bool tag_export_read(struct tag_export *list, const char *path, const char *encoding, char *why, size_t why_bytes);
void tag_export_finish(struct tag_export *list);

/* For the readers of formats. Appends an empty tag and returns it; valid until the next. */
struct export_tag *tag_export_add(struct tag_export *list, int line);
/* Sets a field to a copy of text, unless it has one already or text is blank. */
void export_tag_set(struct export_tag *tag, enum export_field field, const char *text);
/* Reads an Ignition export (JSON). Returns false with the reason. */
bool tag_export_read_json(struct tag_export *list, const char *text, size_t length, char *why, size_t why_bytes);
/* Leaves one tag of each name. */
void tag_export_join(struct tag_export *list);

#endif
