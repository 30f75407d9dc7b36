/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rollups: minimum, maximum, mean, first and last value of a tag in intervals of equal length (buckets), and how long it had no
   value. Only an interval that contains a recorded point gets a bucket. Between two buckets the line is straight, from `last`
   of the first to `first` of the second. No input or output. */
#ifndef HISTORY_ROLLUP_H
#define HISTORY_ROLLUP_H
#include <stddef.h>

#include "history/point.h"

struct history_bucket {
    int64_t t_us; /* start time of the bucket; a multiple of its length */
    /* low: smallest value within the bucket, including its ends, on the line that joins the tag's points; high: largest such
       value; NaN: the bucket has no usable value */
    double low, high;
    double mean; /* mean over the part of the bucket's time that has a value */
    /* first: value at the bucket's start (before any step there) or, if no line leads into the bucket, of its first point;
       last: value at the bucket's end. NaN: no value */
    double first, last;
    int64_t good_us;  /* microseconds of the bucket's time with a value */
    int64_t bad_us;   /* microseconds of the bucket's time without a value */
    uint32_t quality; /* quality at the bucket's end */
};

struct rollup { /* state of computing buckets from the points of one tag; zero-initialise, then set length_us and step */
    int64_t length_us;
    bool step;
    bool has_last, open;
    struct history_point last;
    struct history_bucket bucket;
    double area; /* integral over time of the value in the current bucket, in units of value times microseconds */
};

/* Adds the next point in order of time; a point older than the last one is treated as if it had the last one's time. Returns
   true if the point completes a bucket, which is written to *closed. */
bool rollup_put(struct rollup *rollup, const struct history_point *point, struct history_bucket *closed);
/* Sets *out to the incomplete bucket, up to the last point. Returns false if there is none. */
bool rollup_rest(const struct rollup *rollup, struct history_bucket *out);
/* Merges bucket `b` into bucket `a`. `b` must come later, and both must lie within the same longer bucket. */
void rollup_merge(struct history_bucket *a, const struct history_bucket *b);
/* Adds to the bucket `into` a part of the straight line that leads from the end of bucket `a` (at end_us) to the start of
   bucket `b`: the part between from_us and to_us. Neither `a` nor `b` includes that line. */
void rollup_bridge(struct history_bucket *into, const struct history_bucket *a, int64_t end_us, const struct history_bucket *b,
                   int64_t from_us, int64_t to_us);

#endif
