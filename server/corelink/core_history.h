/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A renderer's HTTP queries (libcurl) to its core, for data that only the core has: recorded series, gaps, the alarm journal,
   and the readings of a past instant. A query blocks for seconds if the core does not answer, so only threads that read history
   may use it, each with its own struct. Queries go only to the core that sends readings, because that core is known to have the
   same plant. */
#ifndef CORELINK_CORE_HISTORY_H
#define CORELINK_CORE_HISTORY_H
#include "base/log/log.h"
#include "base/text/text.h"
#include "corelink/core_link.h"
#include "value/snapshot.h"

struct core_history;
/* Creates a client for queries to the core. Returns NULL if out of memory (logged). `link` must outlive the client. stop: once
   this flag is true, pending queries end soon. */
struct core_history *core_history_create(struct log *log, struct core_link *link, const _Atomic bool *stop);
void core_history_destroy(struct core_history **history); /* frees the history and sets *history to NULL; accepts a pointer to NULL */
/* Appends `name=value` to a path, preceded by `?` or `&`, with the value URL-encoded. */
void core_history_add(struct text *path, const char *name, const char *value);
/* Appends the core's answer to the query `path` to *out. Returns false on failure; logs the failure unless the last logged one
   had the same cause. */
bool core_history_get(struct core_history *history, const char *path, struct text *out);
/* Requests the readings at a past instant and writes them to *snapshot, and the start of the core's history to *first_us (0: no
   history). snapshot NULL: requests only the start of the history. Returns false on failure. */
bool core_history_instant(struct core_history *history, int64_t at_us, struct snapshot *snapshot, int64_t *first_us);

#endif
