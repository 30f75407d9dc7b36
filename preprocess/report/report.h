/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reports what preparing did and what is worth a look, as text for people and JSON for programs. Meanings of the numbers: REPORT.md.
   Thread: one. */
#ifndef PREPROCESS_REPORT_H
#define PREPROCESS_REPORT_H
#include "preprocess/pipeline/prepare.h"

/* What a person should look at. */
struct report_concern {
    const struct prepare_asset *asset;
    char *text;
    double weight; /* the worst is the highest */
};
/* Lists what a person should look at, worst first, and their *count. The caller frees it with report_concerns_free(). */
struct report_concern *report_concerns(const struct prepare *prepare, size_t *count);
/* Frees such a list. */
void report_concerns_free(struct report_concern *concerns, size_t count);

/* Prints tables of what was built, each shortened to some rows unless `all`. */
void report_text(const struct prepare *prepare, bool all, FILE *out);
/* Prints the report as one JSON object. Returns false if out of memory. */
bool report_json(const struct prepare *prepare, FILE *out);

extern const char *const report_states[];                 /* of enum prepare_state */
/* Returns how many vertices preparing added to the model's own. */
uint32_t report_added(const struct prepare_asset *asset);

#endif
