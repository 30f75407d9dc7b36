/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Changes a plant file as a person would: appends lines to its lists, and leaves the rest as it is to the byte. Pure. Thread: any. */
#ifndef PREPROCESS_MATCH_PLANT_EDIT_H
#define PREPROCESS_MATCH_PLANT_EDIT_H
#include "base/text/text.h"

/* The group that `plantcast import` begins a plant file with, so that it is one. */
extern const char plant_edit_placeholder[];

/* Appends lines, each of which ends in a line feed, to a list at the top of the file, such as "groups"; makes the list, before "tags:" or
 * at the end, where there is none. Returns the new text (mem_free), or NULL if the list is not in block style, one item a line. */
char *plant_edit_append(const char *text, const char *list, const char *comment, const char *lines);
/* Replaces all items of a list. Likewise. */
char *plant_edit_replace(const char *text, const char *list, const char *lines);
/* Removes a line that is exactly this. Returns the new text. */
char *plant_edit_remove_line(const char *text, const char *line);
/* Appends text in the quotes of YAML. */
void plant_edit_add_quoted(struct text *out, const char *text);

#endif
