/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The numbers of a build report as JSON, and back: what is kept beside an asset file, so that an asset that did not change has its report
   too. Names and meaning: REPORT.md. Thread: any. */
#ifndef PREPROCESS_REPORT_NUMBERS_H
#define PREPROCESS_REPORT_NUMBERS_H
#include <jansson.h>

#include "preprocess/build.h"

/* NULL: out of memory. */
json_t *report_numbers(const struct build_report *report);
/* False: a number is missing, or is none. */
bool report_numbers_read(const json_t *numbers, struct build_report *report);

#endif
