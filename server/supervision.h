/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Supervision: what the daemon says of its state to the service manager and in /metrics, and what came of a reload in a file. */
#ifndef SUPERVISION_H
#define SUPERVISION_H
#include "base/log/log.h"
#include "base/metrics/counters.h"
#include "net/net_params.h"

struct supervision;
/* From here on the service manager is asked for patience, until the first tick with a render service that is ready. Main thread. */
struct supervision *supervision_create(struct log *log, struct counters *counters);
void supervision_destroy(struct supervision **supervision); /* &NULL is fine; leaves NULL */
/* Says what is waited for before the daemon is ready. Main thread. */
void supervision_starting(struct supervision *supervision, const char *what);
/* Says that the daemon is ready, feeds the watchdog while loop and render thread are alive, and updates metrics. In the loop
   (net_params.tick). */
void supervision_tick(struct supervision *supervision, const struct net_status *status);
/* Notes what came of a reload that began at that monotonic time: metrics, and RUNTIME_DIRECTORY/reload.json, for `plantcast reload`.
   json: of the same form as the answer to POST /api/v1/reload. Any thread, one at a time. */
void supervision_reloaded(struct supervision *supervision, bool good, int64_t begun_ns, const char *json);
/* Says that the daemon ends. Main thread. */
void supervision_stopping(struct supervision *supervision);

#endif
