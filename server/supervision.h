/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Supervision: reports the daemon's state to the service manager and in /metrics, and writes the result of a reload to a file. */
#ifndef SUPERVISION_H
#define SUPERVISION_H
#include "base/log/log.h"
#include "base/metrics/counters.h"
#include "net/net_params.h"

struct supervision;
/* Asks the service manager to wait until supervision_tick() is called with a render service that is ready. Call only in the main thread. */
struct supervision *supervision_create(struct log *log, struct counters *counters);
/* destroys the struct and sets *supervision to NULL; accepts a pointer to NULL */
void supervision_destroy(struct supervision **supervision);
/* Reports which step of the daemon's start has begun. Call only in the main thread. */
void supervision_starting(struct supervision *supervision, const char *what);
/* Reports that the daemon is ready, sends watchdog messages while event loop and render thread are alive, and updates metrics. Called in
   the event loop (net_params.tick). */
void supervision_tick(struct supervision *supervision, const struct net_status *status);
/* Records the result of a reload in metrics, and in RUNTIME_DIRECTORY/reload.json for `plantcast reload`. begun_ns: monotonic
   time when the reload began. json: the answer to POST /api/v1/reload; NULL: nobody requested this reload, so the file
   is not written. Call from any thread, one at a time. */
void supervision_reloaded(struct supervision *supervision, bool good, int64_t begun_ns, const char *json);
/* Reports that the daemon is ending. Call only in the main thread. */
void supervision_stopping(struct supervision *supervision);

#endif
