/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Counts durations in the buckets of a histogram, each of which covers a range of durations. */
#include "base/metrics/histogram.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static const int32_t bounds_us[HISTOGRAM_BUCKETS] = { 500,   1000,  2000,   5000,   10000,  16000,  25000,   33000,
                                                      50000, 75000, 100000, 150000, 250000, 500000, 1000000, 2500000 };

void histogram_add(struct histogram *histogram, int64_t duration_ns)
{
    int64_t us = duration_ns > 0 ? duration_ns / 1000 : 0;
    int bucket = 0;
    while (bucket < HISTOGRAM_BUCKETS && us > bounds_us[bucket])
        bucket++;
    counter_inc(&histogram->buckets[bucket], 1);
    counter_inc(&histogram->sum_us, us);
}

/* Prints the metric's name with a suffix, and its labels plus an additional one if `label` is given: a{b="c"} becomes
   a_bucket{b="c",le="0.1"}. */
static void print_name(const char *name, const char *suffix, const char *label, struct text *out)
{
    int family = (int)strcspn(name, "{"), labels = (int)strlen(name) - family;
    if (labels > 2)
        text_add(out, "%.*s%s{%.*s%s%s} ", family, name, suffix, labels - 2, name + family + 1, *label ? "," : "", label);
    else if (*label)
        text_add(out, "%.*s%s{%s} ", family, name, suffix, label);
    else
        text_add(out, "%.*s%s ", family, name, suffix);
}

void histogram_print(struct histogram *histogram, const char *name, struct text *out)
{
    int64_t count = 0;
    for (int i = 0; i <= HISTOGRAM_BUCKETS; i++) {
        char label[32] = "le=\"+Inf\"";
        if (i < HISTOGRAM_BUCKETS)
            snprintf(label, sizeof(label), "le=\"%g\"", bounds_us[i] / 1e6);
        count += atomic_load_explicit(&histogram->buckets[i], memory_order_relaxed);
        print_name(name, "_bucket", label, out);
        text_add(out, "%" PRId64 "\n", count);
    }
    print_name(name, "_sum", "", out);
    text_add(out, "%.6f\n", (double)atomic_load_explicit(&histogram->sum_us, memory_order_relaxed) / 1e6);
    print_name(name, "_count", "", out);
    text_add(out, "%" PRId64 "\n", count);
}
