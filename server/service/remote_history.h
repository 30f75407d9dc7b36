/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Answers history queries on a renderer (daemon that draws for a core). The core writes the answers, so they are the same to
   the byte as on the core. Each call queries the core and may block for seconds. Call only in a thread that reads history. */
#ifndef SERVICE_REMOTE_HISTORY_H
#define SERVICE_REMOTE_HISTORY_H
#include "corelink/core_history.h"
#include "service/history_query.h"

/* All functions append to *out. They return false if the core did not answer, already logged. */
/* Appends the series of a tag as JSON. first: true: preceded by the beginning of the whole answer; last: true: followed by its end. */
bool remote_history_json(struct core_history *core, const struct history_query *query, const char *tag, bool first, bool last,
                         struct text *out);
/* Appends the series of a tag as CSV. *buckets, updated by the call: whether the last line written has the columns for means of
   time buckets (true) or for single values (false). */
bool remote_history_csv(struct core_history *core, const struct history_query *query, const char *tag, bool first, bool *buckets,
                        struct text *out);
/* Appends the core's complete answer to a query for the times when nothing was recorded, for drifting sensors, or for the alarm
   journal. */
bool remote_history_whole(struct core_history *core, const struct plant *plant, const struct history_query *query, struct text *out);

#endif
