/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Judges which sensors of a group on an asset drifted in the week before an instant (field/drift.h), from recorded history, and
   writes the result as text (HTTP.md, /api/v1/drift). Call only in a thread that reads history. */
#ifndef SERVICE_DRIFT_REPORT_H
#define SERVICE_DRIFT_REPORT_H
#include "base/text/text.h"
#include "field/drift.h"
#include "history/history.h"

struct drift_report {
    /* estimates each sensor from its neighbours (field/neighbours.h); NULL: no sensor has a known position */
    struct neighbours *neighbours;
    size_t count;                  /* number of sensors */
    struct drift *drifts;          /* verdict of each sensor */
    /* hourly means of the readings, and their estimates from the neighbouring sensors, indexed [hour][sensor]; NaN: no reading, or no
       estimate */
    double *values, *predicted;
    int64_t from_us; /* start of the first of DRIFT_HOURS hours, UTC microseconds */
};

/* Reads the recorded history of the group's sensors on the asset and judges their drift. reader: reads the history of the
   scene's plant. Returns false if history cannot be read, already logged. After true, the caller frees the report with
   drift_report_finish(). */
bool drift_report_read(struct drift_report *report, struct history_reader *reader, const struct scene *scene, int asset, int group,
                       int64_t to_us);
void drift_report_finish(struct drift_report *report);

/* drift_text_begin() appends the beginning of the JSON answer, drift_text_add() the sensors of one report, drift_text_end() the
   end. tag: only that tag, with its hourly values; -1: all. *any is set once a sensor was appended, so that a comma precedes
   the next one. */
void drift_text_begin(struct text *out, const struct plant *plant, int group, int64_t to_us);
void drift_text_add(struct text *out, const struct plant *plant, const struct drift_report *report, int tag, bool *any);
void drift_text_end(struct text *out);
/* Returns the name of a verdict on a sensor's drift, as used in the JSON answer. */
const char *drift_verdict_name(enum drift_verdict verdict);

#endif
