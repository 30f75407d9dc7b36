/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What was done and what is worth a look, for people and for programs. What each number means: REPORT.md. Thread: one. */
#ifndef PREPROCESS_REPORT_H
#define PREPROCESS_REPORT_H
#include "preprocess/pipeline/prepare.h"

/* What a person should look at. */
struct report_concern {
    const struct prepare_asset *asset;
    char *text;
    double weight; /* the worst is the highest */
};
/* Worst first; free with report_concerns_free. */
struct report_concern *report_concerns(const struct prepare *prepare, size_t *count);
void report_concerns_free(struct report_concern *concerns, size_t count);

/* Tables of what was built, each cut after some rows; all: of every asset, whole. */
void report_text(const struct prepare *prepare, bool all, FILE *out);
/* One JSON object. False: out of memory. */
bool report_json(const struct prepare *prepare, FILE *out);

extern const char *const report_states[];                 /* of enum prepare_state */
uint32_t report_added(const struct prepare_asset *asset); /* vertices that preparing added to the model's own */

#endif
