/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What one tag did in a stretch of time: its lowest, highest, mean and last value, and how long it had none. Pure.
   Only stretches with a kept point in them come out: between two that do, the line goes on straight, from `last` to `first`. */
#ifndef HISTORY_ROLLUP_H
#define HISTORY_ROLLUP_H
#include <stddef.h>

#include "history/point.h"

struct history_bucket {
    int64_t t_us;          /* its beginning; a multiple of its length */
    double low, high;      /* NaN: no usable value in it. The line where it enters and leaves counts too */
    double mean;           /* over the time that had a value */
    double first, last;    /* at its beginning, or of its first point where no line leads in; at its end. NaN: none */
    int64_t good_us;       /* how long there was a value */
    int64_t bad_us;        /* how long there was none */
    uint32_t quality;      /* at its end */
};

struct rollup { /* zero-initialise, then set length_us and step */
    int64_t length_us;
    bool step;
    bool has_last, open;
    struct history_point last;
    struct history_bucket bucket;
    double area; /* value times microseconds */
};

/* The next point, in order of time (one that is not is taken as if it came at the time of the last). True: *closed is whole. */
bool rollup_put(struct rollup *rollup, const struct history_point *point, struct history_bucket *closed);
/* The bucket that is still open, up to the last point. False: there is none. */
bool rollup_rest(const struct rollup *rollup, struct history_bucket *out);
/* Puts buckets of a shorter length together: b follows a within the same longer one. */
void rollup_merge(struct history_bucket *a, const struct history_bucket *b);
/* Adds to `into` what lies between from_us and to_us of the line from the end of a, at end_us, to the beginning of b. */
void rollup_bridge(struct history_bucket *into, const struct history_bucket *a, int64_t end_us, const struct history_bucket *b,
                   int64_t from_us, int64_t to_us);

#endif
