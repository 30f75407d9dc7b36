/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a renderer asks its core for over HTTP (libcurl), since only the core has it: recorded series, gaps, the alarm journal, and the
   readings of an instant. Blocks for seconds where the core does not answer: for threads that read history, each with its own. Only the
   core that readings come from is asked, which so is known to have the same plant. */
#ifndef CORELINK_CORE_HISTORY_H
#define CORELINK_CORE_HISTORY_H
#include "base/log/log.h"
#include "base/text/text.h"
#include "corelink/core_link.h"
#include "value/snapshot.h"

struct core_history;
/* Returns NULL if there is no memory (logged). The link outlives it. stop: once it is true, what waits ends soon. */
struct core_history *core_history_create(struct log *log, struct core_link *link, const _Atomic bool *stop);
void core_history_destroy(struct core_history **history); /* &NULL is fine; leaves NULL */
/* Appends `name=value` to a path, with `?` or `&` before it, the value encoded. */
void core_history_add(struct text *path, const char *name, const char *value);
/* Appends what the core has at the path to *out. Returns false if it cannot be had: logged when it is another cause than the last time. */
bool core_history_get(struct core_history *history, const char *path, struct text *out);
/* Reads the readings of an instant into *snapshot, and where history begins (0: there is none). snapshot: NULL: only that. Returns false
   likewise. */
bool core_history_instant(struct core_history *history, int64_t at_us, struct snapshot *snapshot, int64_t *first_us);

#endif
