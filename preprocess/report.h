/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What was done, for people and for programs. */
#ifndef PREPROCESS_REPORT_H
#define PREPROCESS_REPORT_H
#include "preprocess/prepare.h"

void report_text(const struct prepare *prepare, FILE *out);
/* One JSON object. False: out of memory. */
bool report_json(const struct prepare *prepare, FILE *out);

#endif
