/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edits a plant file as text: appends lines to its lists and leaves all other bytes unchanged. No side effects. Call from any thread. */
#ifndef PREPROCESS_MATCH_PLANT_EDIT_H
#define PREPROCESS_MATCH_PLANT_EDIT_H
#include "base/text/text.h"

/* line of the placeholder group in a plant file written by `plantcast import`, which would be invalid without a group */
extern const char plant_edit_placeholder[];

/* Appends lines, each ending in a line feed, to a top-level list such as "groups". If the list is missing, creates it, preceded
 * by the text `comment`, before "tags:" or at the end of the file. Returns the new text, which the caller frees (mem_free), or
 * NULL if the list is not in block style, one item per line. */
char *plant_edit_append(const char *text, const char *list, const char *comment, const char *lines);
/* Replaces all items of a top-level list by lines. Returns the new text, which the caller frees (mem_free), or NULL if the list is not in
 * block style. */
char *plant_edit_replace(const char *text, const char *list, const char *lines);
/* Removes the line equal to `line`. Returns the new text, which the caller frees (mem_free). */
char *plant_edit_remove_line(const char *text, const char *line);
/* Appends text as a quoted YAML scalar. */
void plant_edit_add_quoted(struct text *out, const char *text);

#endif
