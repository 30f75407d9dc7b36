/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reports the result of preparing a plant and possible problems, as text for people and as JSON for programs. REPORT.md
 * explains the numbers. Call from one thread only. */
#ifndef PREPROCESS_REPORT_H
#define PREPROCESS_REPORT_H
#include "preprocess/pipeline/prepare.h"

/* A possible problem that the report points out. */
struct report_concern {
    const struct prepare_asset *asset;
    char *text;
    double weight; /* severity of the problem; the report lists problems with a larger number first */
};
/* Lists possible problems, most serious first; *count receives their number. The caller frees the list with report_concerns_free(). */
struct report_concern *report_concerns(const struct prepare *prepare, size_t *count);
int report_concern_compare(const void *a, const void *b); /* orders struct report_concern for qsort(), the most serious first */
/* Frees a list of report_concerns(). */
void report_concerns_free(struct report_concern *concerns, size_t count);

/* Prints the report as tables, each limited to ROWS_MAX rows unless `all`. */
void report_text(const struct prepare *prepare, bool all, FILE *out);
/* Prints the report as one JSON object. Returns false if out of memory. */
bool report_json(const struct prepare *prepare, FILE *out);

extern const char *const report_states[]; /* by enum prepare_state: name in reports */
/* Returns the number of vertices that preparation added to the model's. */
uint32_t report_added(const struct prepare_asset *asset);

#endif
