/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which sensors of a group on an asset drifted in the week before an instant (field/drift.h), from recorded history, and that as text
   (PROTOCOL.md, /api/v1/drift). Thread: one that reads history. */
#ifndef SERVICE_DRIFT_REPORT_H
#define SERVICE_DRIFT_REPORT_H
#include "base/text/text.h"
#include "field/drift.h"
#include "history/history.h"

struct drift_report {
    struct neighbours *neighbours;  /* NULL: there are no sensors whose places are known */
    size_t count;                   /* of sensors */
    struct drift *drifts;           /* by sensor */
    double *values, *predicted;     /* [hour][sensor]; NaN: none */
    int64_t from_us;                /* the first of DRIFT_HOURS hours begins */
};

/* Reads and judges. reader: shows by the scene's plant. Returns false if history cannot be read, already logged. Finish it if true. */
bool drift_report_read(struct drift_report *report, struct history_reader *reader, const struct scene *scene, int asset, int group,
                       int64_t to_us);
void drift_report_finish(struct drift_report *report);

/* What comes before, for each report, and after. tag: of that one alone, with its hours; -1: of all. *any: something was
   listed before. */
void drift_text_begin(struct text *out, const struct plant *plant, int group, int64_t to_us);
void drift_text_add(struct text *out, const struct plant *plant, const struct drift_report *report, int tag, bool *any);
void drift_text_end(struct text *out);
/* Returns the verdict's word. */
const char *drift_verdict_name(enum drift_verdict verdict);

#endif
