/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts a reader's output about a model into JSON for programs and lines for people. Call from one thread per object. A
 * reader prints plain lines and tab-separated records: "lost ID NAME CLASS GUID REASON" for an element that has a shape but no
 * triangles; "flat #NUMBER NAME CLASS GUID REASON" for a node whose triangles have no area; "error COUNT TEXT" for an error
 * that a library logged; "unit UNIT LENGTH" if the file gives no unit and the reader assumed UNIT (LENGTH: longest side of the
 * model in units of the file). */
#ifndef PREPROCESS_IMPORT_FINDINGS_H
#define PREPROCESS_IMPORT_FINDINGS_H
#include <jansson.h>
#include <stdio.h>

#include "base/text/text.h"

/* Returns the findings of one model: {file, lost_count, lost (at most 20,000): [{id, name, class, guid, why}], errors: [{count,
 * text}], left_out: [text], unit: {taken, length} or null, failed: text or null}. said: the reader's output; failed: why the
 * model was not imported, or NULL. Appends the lines printed for users to `plain`. */
json_t *findings_read(const char *file, const char *said, const char *failed, struct text *plain);
/* Prints lines, such as findings_read()'s `plain`, each after the path of their model. lines: NULL: prints nothing. */
void findings_print(const char *path, const char *lines, FILE *out);
/* Returns the length in metres of the unit that the reader assumed (m or mm), from the result of findings_read(); 0: none. */
double findings_guessed_m(const json_t *findings);
/* Sets flat[N] to true for each node number N below `count` that the reader's output lists as "flat". */
void findings_flat_nodes(const char *said, bool *flat, size_t count);

#endif
