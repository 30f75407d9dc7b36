/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The metrics that Prometheus expects of every process: CPU time, memory, files, threads, start time. Call from any thread. */
#ifndef BASE_METRICS_PROCESS_COUNTERS_H
#define BASE_METRICS_PROCESS_COUNTERS_H
#include "base/metrics/counters.h"

/* Measures this process's CPU time, memory, files and threads, and sets the metrics process_*. */
void process_counters_set(struct counters *counters);

#endif
