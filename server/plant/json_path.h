/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Paths to values in JSON: `name.name[0]["odd name"]`, with or without `$` or `$.` in front. Thread: any. */
#ifndef PLANT_JSON_PATH_H
#define PLANT_JSON_PATH_H
#include <stdbool.h>
#include <stddef.h>

struct json_path_step {
    const char *name; /* of a member, not terminated; NULL: an item of an array */
    size_t length;    /* of the name */
    size_t index;     /* of the item */
};

/* Returns whether text is a path; else says in why what was expected. */
bool json_path_check(const char *text, char why[200]);
/* Returns the path's text behind its `$`, from where json_path_next() begins. */
const char *json_path_begin(const char *text);
/* Reads one step and moves *at behind it. Returns false at the end of the path, and where it is wrong. */
bool json_path_next(const char **at, struct json_path_step *out);

#endif
