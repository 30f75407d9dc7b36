/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Supervision: reports the daemon's state to the service manager and in /metrics, and the result of a reload in a file. */
#ifndef SUPERVISION_H
#define SUPERVISION_H
#include "base/log/log.h"
#include "base/metrics/counters.h"
#include "net/net_params.h"

struct supervision;
/* Keeps the service manager waiting from now on, until the first tick with a render service that is ready. Main thread. */
struct supervision *supervision_create(struct log *log, struct counters *counters);
void supervision_destroy(struct supervision **supervision); /* &NULL is allowed; sets *supervision to NULL */
/* Reports the step of the daemon's start that has begun. Main thread. */
void supervision_starting(struct supervision *supervision, const char *what);
/* Reports that the daemon is ready, feeds the watchdog while event loop and render thread are alive, and updates metrics. Called in the
   event loop (net_params.tick). */
void supervision_tick(struct supervision *supervision, const struct net_status *status);
/* Records the result of a reload: in metrics, and in RUNTIME_DIRECTORY/reload.json for `plantcast reload`. begun_ns: monotonic start of
   the reload. json: the answer to POST /api/v1/reload. Any thread, one at a time. */
void supervision_reloaded(struct supervision *supervision, bool good, int64_t begun_ns, const char *json);
/* Reports that the daemon is ending. Main thread. */
void supervision_stopping(struct supervision *supervision);

#endif
