/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes rollups (minimum, maximum and mean of time intervals) from the straight lines between the recorded points of one
   tag, one line after the other. */
#include "history/rollup.h"

static int64_t floor_to(int64_t t_us, int64_t length_us)
{
    int64_t rest = t_us % length_us;
    return t_us - (rest < 0 ? rest + length_us : rest);
}

static void open_bucket(struct rollup *rollup, int64_t t_us)
{
    rollup->bucket = (struct history_bucket){ .t_us = floor_to(t_us, rollup->length_us),
                                              .low = NAN,
                                              .high = NAN,
                                              .mean = NAN,
                                              .first = NAN,
                                              .last = NAN,
                                              .quality = rollup->last.quality };
    rollup->area = 0;
    rollup->open = true;
}

static void take_value(struct history_bucket *bucket, double value)
{
    bucket->low = fmin(bucket->low, value); /* fmin and fmax ignore NaN */
    bucket->high = fmax(bucket->high, value);
}

/* Adds to the current bucket the part between t0_us and t1_us of the straight line from the point rollup->last to the point
   `next`. next NULL: the value of rollup->last holds over that time. */
static void take_part(struct rollup *rollup, const struct history_point *next, int64_t t0_us, int64_t t1_us)
{
    struct history_bucket *bucket = &rollup->bucket;
    if (t1_us <= t0_us)
        return;
    if (!history_point_usable(&rollup->last)) {
        bucket->bad_us += t1_us - t0_us;
        bucket->last = NAN;
        return;
    }
    double a = rollup->last.value, b = a;
    if (next && history_point_joined(&rollup->last, next, rollup->step)) {
        a = history_point_between(&rollup->last, next, t0_us);
        b = history_point_between(&rollup->last, next, t1_us);
    }
    take_value(bucket, a);
    take_value(bucket, b);
    if (isnan(bucket->first) && bucket->bad_us == 0)
        bucket->first = a;
    bucket->last = b;
    rollup->area += (a + b) / 2 * (double)(t1_us - t0_us);
    bucket->good_us += t1_us - t0_us;
    bucket->mean = rollup->area / (double)bucket->good_us;
}

static void take_point(struct rollup *rollup, const struct history_point *point)
{
    rollup->bucket.quality = point->quality;
    rollup->bucket.last = NAN;
    if (!history_point_usable(point))
        return;
    take_value(&rollup->bucket, point->value);
    if (isnan(rollup->bucket.first) && rollup->bucket.bad_us == 0)
        rollup->bucket.first = point->value;
    rollup->bucket.last = point->value;
    if (rollup->bucket.good_us == 0)
        rollup->bucket.mean = point->value;
}

bool rollup_put(struct rollup *rollup, const struct history_point *point, struct history_bucket *closed)
{
    struct history_point next = *point;
    bool closes = false;
    if (rollup->has_last && next.t_us < rollup->last.t_us)
        next.t_us = rollup->last.t_us;
    if (rollup->open) {
        int64_t end_us = rollup->bucket.t_us + rollup->length_us;
        take_part(rollup, &next, rollup->last.t_us, next.t_us < end_us ? next.t_us : end_us);
        closes = next.t_us >= end_us;
        if (closes) {
            *closed = rollup->bucket;
            rollup->open = false;
        }
    }
    if (!rollup->open) {
        open_bucket(rollup, next.t_us);
        if (rollup->has_last)
            take_part(rollup, &next, rollup->bucket.t_us > rollup->last.t_us ? rollup->bucket.t_us : rollup->last.t_us, next.t_us);
        /* the point is at the bucket's start, and no straight line leads from the previous point to it: the previous point's
           value holds until then, and is the bucket's first value */
        if (rollup->has_last && next.t_us == rollup->bucket.t_us && history_point_usable(&rollup->last) &&
            !history_point_joined(&rollup->last, &next, rollup->step))
            rollup->bucket.first = rollup->last.value;
    }
    rollup->last = next;
    rollup->has_last = true;
    take_point(rollup, &next);
    return closes;
}

bool rollup_rest(const struct rollup *rollup, struct history_bucket *out)
{
    if (rollup->open)
        *out = rollup->bucket;
    return rollup->open;
}

/* Adds good_us microseconds with the given mean value to the bucket's mean. */
static void add_time(struct history_bucket *bucket, double mean, int64_t good_us)
{
    if (good_us <= 0)
        return;
    double before = bucket->good_us > 0 ? bucket->mean * (double)bucket->good_us : 0;
    bucket->good_us += good_us;
    bucket->mean = (before + mean * (double)good_us) / (double)bucket->good_us;
}

void rollup_merge(struct history_bucket *a, const struct history_bucket *b)
{
    if (a->good_us == 0 && b->good_us == 0 && isnan(a->mean))
        a->mean = b->mean;
    add_time(a, b->mean, b->good_us);
    a->low = fmin(a->low, b->low);
    a->high = fmax(a->high, b->high);
    if (isnan(a->first) && a->bad_us == 0)
        a->first = b->first;
    a->last = b->last;
    a->bad_us += b->bad_us;
    a->quality = b->quality;
}

void rollup_bridge(struct history_bucket *into, const struct history_bucket *a, int64_t end_us, const struct history_bucket *b,
                   int64_t from_us, int64_t to_us)
{
    if (to_us <= from_us)
        return;
    if (isnan(a->last)) {
        into->bad_us += to_us - from_us;
        return;
    }
    /* the slope is 0 if bucket `b` has no first value: earlier versions of the file stored none if the first point of `b` has
       no value */
    double slope = isnan(b->first) ? 0 : (b->first - a->last) / (double)(b->t_us - end_us);
    double enter = a->last + slope * (double)(from_us - end_us), leave = a->last + slope * (double)(to_us - end_us);
    take_value(into, enter);
    take_value(into, leave);
    if (isnan(into->first) && into->bad_us == 0)
        into->first = enter;
    into->last = leave;
    add_time(into, (enter + leave) / 2, to_us - from_us);
}
