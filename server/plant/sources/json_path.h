/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Paths to one value in JSON, in the words of JSONPath (RFC 9535): `$.name['odd name'][0][?@.id=='A.T2'].v`. The `$.` may be left out, and
   in filters the `@.`. All that can only select several values (wildcards, slices, `..`) is refused. Thread: any. */
#ifndef PLANT_SOURCES_JSON_PATH_H
#define PLANT_SOURCES_JSON_PATH_H
#include <stdbool.h>
#include <stddef.h>

enum { JSON_PATH_TEXT_BYTES = 128, JSON_PATH_MAX_TESTS = 4 };

enum json_literal_kind { JSON_LITERAL_STRING, JSON_LITERAL_NUMBER, JSON_LITERAL_TRUE, JSON_LITERAL_FALSE, JSON_LITERAL_NULL };

struct json_path_test { /* `@.a.b == literal` */
    const char *path;   /* behind the `@`: names and indices, for json_path_next_operand() until `end` */
    const char *end;
    enum json_literal_kind kind;
    double number;
    char text[JSON_PATH_TEXT_BYTES]; /* of a string, terminated */
};

enum json_path_kind { JSON_PATH_NAME, JSON_PATH_INDEX, JSON_PATH_FILTER };

struct json_path_step {
    enum json_path_kind kind;
    char name[JSON_PATH_TEXT_BYTES];                  /* of a member, terminated */
    long index;                                       /* of an array's item; negative: from its end */
    struct json_path_test tests[JSON_PATH_MAX_TESTS]; /* of a filter: an item is selected if all of them hold */
    int test_count;
};

/* Returns whether text is a path; else `why` says what was expected. relative: a path that begins with `@` is one, too. */
bool json_path_check(const char *text, bool relative, char why[200]);
/* Returns where the steps of a path begin: behind its `$` or `@`. */
const char *json_path_begin(const char *text);
/* Reads one step and moves *at behind it. Returns false at the end of the path, and where it is wrong (`why` says how). */
bool json_path_next(const char **at, struct json_path_step *out, char why[200]);
/* The same in a path inside a filter, where a name ends at blanks and operators. */
bool json_path_next_operand(const char **at, struct json_path_step *out, char why[200]);

#endif
