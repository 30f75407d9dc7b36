/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An atomic number that threads update without a lock. Call from any thread. */
#ifndef BASE_METRICS_COUNTER_H
#define BASE_METRICS_COUNTER_H
#include <stdatomic.h>
#include <stdint.h>

typedef _Atomic int64_t counter;

/* Adds to a counter. */
static inline void counter_inc(counter *c, int64_t by)
{
    atomic_fetch_add_explicit(c, by, memory_order_relaxed);
}
/* Sets a counter to a value; only for counters that are gauges, whose values may also fall. */
static inline void counter_set(counter *c, int64_t to)
{
    atomic_store_explicit(c, to, memory_order_relaxed);
}

#endif
