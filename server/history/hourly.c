/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the mean of a tag's recorded values for each hour, from the buckets of its series. */
#include "history/history.h"

#include "history/month.h"

static const int64_t HOUR_US = 3600 * US_PER_S;

/* Sets the hourly means between two one-hour buckets that are not adjacent. No point was recorded in these hours, so each mean
   lies on the straight line between the buckets. */
static void fill_between(const struct history_series *series, const struct history_bucket *a, const struct history_bucket *b,
                         int64_t from_us, int hours, double *means)
{
    int64_t begin_us = a->t_us + HOUR_US, span_us = b->t_us - begin_us;
    for (int64_t t_us = begin_us; t_us < b->t_us; t_us += HOUR_US) {
        int64_t hour = (t_us - from_us) / HOUR_US;
        double part = ((double)(t_us - begin_us) + 0.5 * (double)HOUR_US) / (double)span_us;
        if (t_us >= from_us && hour < hours)
            means[hour] = series->step ? a->last : a->last + part * (b->first - a->last);
    }
}

int history_hourly(struct history_reader *reader, const char *tag, int64_t to_us, int hours, double *means)
{
    int64_t end_us = to_us - to_us % HOUR_US, from_us = end_us - hours * HOUR_US;
    struct history_series series;
    for (int h = 0; h < hours; h++)
        means[h] = NAN;
    int error = history_intervals(reader, tag, from_us, end_us - 1, hours, &series);
    for (size_t i = 0; i < series.buckets.count && !error; i++) {
        const struct history_bucket *bucket = &series.buckets.at[i];
        int64_t hour = bucket->t_us >= from_us ? (bucket->t_us - from_us) / HOUR_US : -1;
        if (hour >= 0 && hour < hours && 2 * bucket->good_us >= HOUR_US)
            means[hour] = bucket->mean;
        if (i > 0)
            fill_between(&series, bucket - 1, bucket, from_us, hours, means);
    }
    history_series_finish(&series);
    return error;
}
