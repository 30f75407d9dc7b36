/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A histogram of durations in Prometheus format. Call from any thread; each bucket is one atomic. */
#ifndef BASE_METRICS_HISTOGRAM_H
#define BASE_METRICS_HISTOGRAM_H
#include "base/metrics/counter.h"
#include "base/text/text.h"

enum { HISTOGRAM_BUCKETS = 16 };
struct histogram {
    counter buckets[HISTOGRAM_BUCKETS + 1]; /* number of durations per bucket; the last bucket is for durations longer than all bounds */
    counter sum_us;
};

void histogram_add(struct histogram *histogram, int64_t duration_ns); /* Counts a duration; a negative one counts as 0. */
/* Prints the histogram. `name` may have labels, as in counters_add(). */
void histogram_print(struct histogram *histogram, const char *name, struct text *out);

#endif
