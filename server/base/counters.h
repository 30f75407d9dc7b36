/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Registry of metrics: named numbers and histograms, printed for /metrics in the text format of Prometheus. Thread: any. */
#ifndef BASE_COUNTERS_H
#define BASE_COUNTERS_H
#include <stdatomic.h>
#include <stdint.h>

#include "base/text.h"

struct counters;
typedef _Atomic int64_t counter;

struct counters *counters_create(void);
void counters_destroy(struct counters **counters);
/* Registers a metric, or finds it if it is registered already. name may have labels: `plantcast_reads_total{source="plc1"}`; type is
   "counter" or "gauge". Returns the number, which lives as long as `counters`. help and type are copied. */
counter *counters_add(struct counters *counters, const char *name, const char *type, const char *help);
/* Likewise, of durations (base/histogram.h); in seconds. */
struct histogram *counters_add_histogram(struct counters *counters, const char *name, const char *help);
/* Appends all metrics in the text format of Prometheus. */
void counters_print(struct counters *counters, struct text *out);

static inline void counter_inc(counter *c, int64_t by)
{
    atomic_fetch_add_explicit(c, by, memory_order_relaxed);
}
static inline void counter_set(counter *c, int64_t to)
{
    atomic_store_explicit(c, to, memory_order_relaxed);
}

#endif
