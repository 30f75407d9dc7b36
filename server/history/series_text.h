/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes history series as JSON and as CSV, as described in protocol/HTTP.md. No input or output. Call from any thread. */
#ifndef HISTORY_SERIES_TEXT_H
#define HISTORY_SERIES_TEXT_H
#include "base/text/text.h"
#include "history/history.h"

/* Appends one JSON object: {"tag":...,"unit":...,"step":...,"bucket_s":...,"points":[...]} */
void series_text_json(struct text *out, const char *tag, const char *unit, const struct history_series *series);
/* Appends the CSV header line for points or for buckets. series_text_csv() appends the rows of a series. */
void series_text_csv_head(struct text *out, bool buckets);
void series_text_csv(struct text *out, const char *tag, const char *unit, const struct history_series *series);

#endif
