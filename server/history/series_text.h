/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What was asked of the historian, as JSON and as CSV. protocol/PROTOCOL.md describes both. Pure. */
#ifndef HISTORY_SERIES_TEXT_H
#define HISTORY_SERIES_TEXT_H
#include "base/text.h"
#include "history/history.h"

/* One object: {"tag":...,"unit":...,"step":...,"bucket_s":...,"points":[...]} */
void series_text_json(struct text *out, const char *tag, const char *unit, const struct history_series *series);
/* Its rows, and once before all of them the line that names the columns: of points, or of buckets. */
void series_text_csv_head(struct text *out, bool buckets);
void series_text_csv(struct text *out, const char *tag, const char *unit, const struct history_series *series);

#endif
