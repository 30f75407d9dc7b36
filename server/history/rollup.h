/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rollups: minimum, maximum, mean and last value of a tag in intervals of equal length (buckets), and for how long it had no value. Pure.
   Only intervals that contain a recorded point make a bucket; between two buckets the line is straight, from `last` to `first`. */
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

/* Adds the next point in order of time; an older one counts as if it were at the time of the last. Returns true if this completes a
   bucket, *closed. */
bool rollup_put(struct rollup *rollup, const struct history_point *point, struct history_bucket *closed);
/* Gets the incomplete bucket, up to the last point. Returns false if there is none. */
bool rollup_rest(const struct rollup *rollup, struct history_bucket *out);
/* Adds bucket b to bucket a; b follows a within the same longer bucket. */
void rollup_merge(struct history_bucket *a, const struct history_bucket *b);
/* Adds to `into` what lies between from_us and to_us of the line from the end of a, at end_us, to the beginning of b. */
void rollup_bridge(struct history_bucket *into, const struct history_bucket *a, int64_t end_us, const struct history_bucket *b,
                   int64_t from_us, int64_t to_us);

#endif
