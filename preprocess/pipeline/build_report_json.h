/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The numbers of a build report as JSON, and back: what is kept beside an asset file, so that an asset that did not change has its report
   too. Names and meaning: REPORT.md. Thread: any. */
#ifndef PREPROCESS_PIPELINE_BUILD_REPORT_JSON_H
#define PREPROCESS_PIPELINE_BUILD_REPORT_JSON_H
#include <jansson.h>

#include "preprocess/pipeline/build.h"

/* NULL: out of memory. */
json_t *build_report_to_json(const struct build_report *report);
/* False: a number is missing, or is none. */
bool build_report_from_json(const json_t *numbers, struct build_report *report);

#endif
