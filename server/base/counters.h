/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Named numbers for /metrics, in Prometheus text form. Thread: any; a counter is one atomic. */
#ifndef BASE_COUNTERS_H
#define BASE_COUNTERS_H
#include <stdatomic.h>
#include <stdint.h>

#include "base/text.h"

struct counters;
typedef _Atomic int64_t counter;

struct counters *counters_create(void);
void counters_destroy(struct counters **counters);
/* Registers a name (`plantcast_frames_total`, labels allowed: `plantcast_reads_total{source="plc1"}`), or finds it again.
   type is "counter" or "gauge". The address stays valid as long as `counters`. help and type need only live for the call. */
counter *counters_add(struct counters *counters, const char *name, const char *type, const char *help);
/* Likewise, of durations (base/histogram.h); in seconds. */
struct histogram *counters_add_histogram(struct counters *counters, const char *name, const char *help);
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
