/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts a build report to JSON and back. The report is stored next to the asset file, so that it is still available when the
 * asset is unchanged. REPORT.md explains the names. Call from any thread. */
#ifndef PREPROCESS_PIPELINE_BUILD_REPORT_JSON_H
#define PREPROCESS_PIPELINE_BUILD_REPORT_JSON_H
#include <jansson.h>

#include "preprocess/pipeline/build.h"

/* Returns the report as a JSON object, which the caller releases with json_decref(). NULL: out of memory. */
json_t *build_report_to_json(const struct build_report *report);
/* Reads the numbers of a JSON object into *report. Returns false if a number is missing or of the wrong type. */
bool build_report_from_json(const json_t *numbers, struct build_report *report);

#endif
