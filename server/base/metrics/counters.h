/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Registry of metrics: named numbers and histograms, printed for /metrics in the text format of Prometheus. Call from any thread. */
#ifndef BASE_METRICS_COUNTERS_H
#define BASE_METRICS_COUNTERS_H
#include "base/metrics/counter.h"
#include "base/metrics/histogram.h"
#include "base/text/text.h"

struct counters;

struct counters *counters_create(void);
void counters_destroy(struct counters **counters);
/* Registers a metric, or returns the existing one of that name. `name` may have labels: `plantcast_reads_total{source="plc1"}`; `type`
   is "counter" or "gauge". Returns the metric's counter, which lives as long as `counters`. `help` and `type` are copied. */
counter *counters_add(struct counters *counters, const char *name, const char *type, const char *help);
/* Like counters_add(), for a counter kept in microseconds and printed in seconds. */
counter *counters_add_seconds(struct counters *counters, const char *name, const char *type, const char *help);
/* Like counters_add(), for a histogram of durations (base/metrics/histogram.h), printed in seconds. */
struct histogram *counters_add_histogram(struct counters *counters, const char *name, const char *help);
/* Appends all metrics in the text format of Prometheus. */
void counters_print(struct counters *counters, struct text *out);

#endif
