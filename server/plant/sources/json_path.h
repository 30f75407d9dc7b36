/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Paths to one value in JSON, in the syntax of JSONPath (RFC 9535): `$.name['odd name'][0][?@.id=='A.T2'].v`. The leading `$.`,
   and `@.` in filters, may be omitted. Selectors of several values (wildcards, slices, `..`) are refused. Call from any thread. */
#ifndef PLANT_SOURCES_JSON_PATH_H
#define PLANT_SOURCES_JSON_PATH_H
#include <stdbool.h>
#include <stddef.h>

enum { JSON_PATH_TEXT_BYTES = 128, JSON_PATH_MAX_TESTS = 4 };

enum json_literal_kind { JSON_LITERAL_STRING, JSON_LITERAL_NUMBER, JSON_LITERAL_TRUE, JSON_LITERAL_FALSE, JSON_LITERAL_NULL };

struct json_path_test { /* one comparison in a filter of a path, such as `@.a.b == 'x'` */
    const char *path;   /* path on the left side, after its `@`: names and indices, to be read with json_path_next_operand() up to `end` */
    const char *end;
    enum json_literal_kind kind;
    double number;
    char text[JSON_PATH_TEXT_BYTES]; /* text of the literal on the right side if it is a string, 0-terminated */
};

enum json_path_kind { JSON_PATH_NAME, JSON_PATH_INDEX, JSON_PATH_FILTER };

struct json_path_step {
    enum json_path_kind kind;
    char name[JSON_PATH_TEXT_BYTES];                  /* name of a member, 0-terminated */
    long index;                                       /* index of an item in the array; negative: counted from the end */
    struct json_path_test tests[JSON_PATH_MAX_TESTS]; /* comparisons of a filter; an item is selected if all comparisons hold */
    int test_count;
};

/* Returns whether `text` is a valid path; if not, `why` has the expected form. relative: a path that begins with `@` is accepted too. */
bool json_path_check(const char *text, bool relative, char why[200]);
/* Returns the position of a path's first step: after its `$` or `@`. */
const char *json_path_begin(const char *text);
/* Reads one step and moves *at past it. Returns false at the end of the path (`why` unchanged) or at a syntax error (reason in `why`). */
bool json_path_next(const char **at, struct json_path_step *out, char why[200]);
/* Like json_path_next(), but for a path inside a filter, where a name also ends at a blank or a comparison operator. */
bool json_path_next_operand(const char **at, struct json_path_step *out, char why[200]);

#endif
