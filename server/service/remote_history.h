/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A renderer's answers to history queries, which its core writes: the same bytes as where the history is. Each call asks the core, and may
   block for seconds. Thread: one that reads history. */
#ifndef SERVICE_REMOTE_HISTORY_H
#define SERVICE_REMOTE_HISTORY_H
#include "corelink/core_history.h"
#include "service/history_query.h"

/* Append to *out; return false if the core cannot be asked, already logged. */
/* The series of a tag, in JSON; first, last: what stands before the first one of a query, and after the last. */
bool remote_history_json(struct core_history *core, const struct history_query *query, const char *tag, bool first, bool last,
                         struct text *out);
/* Likewise in CSV. *buckets: the columns of the line before; becomes those of this one. */
bool remote_history_csv(struct core_history *core, const struct history_query *query, const char *tag, bool first, bool *buckets,
                        struct text *out);
/* Gaps, drifting sensors, or the journal. */
bool remote_history_whole(struct core_history *core, const struct plant *plant, const struct history_query *query, struct text *out);

#endif
