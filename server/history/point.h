/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A recorded point of a tag. Points are joined by straight lines, or by steps if the tag is a switch. Pure. Call from any thread. */
#ifndef HISTORY_POINT_H
#define HISTORY_POINT_H
#include <math.h>
#include <stdbool.h>
#include <stdint.h>

struct history_point {
    int64_t t_us;     /* time of the point, UTC since 1970 */
    double value;     /* value in the tag's unit; NaN: no value */
    uint32_t quality; /* OPC UA quality, valid from this point until the next */
};

/* Returns true if the point has a value and its quality is not Bad. */
static inline bool history_point_usable(const struct history_point *p)
{
    return (p->quality >> 30) < 2 && !isnan(p->value);
}
/* Returns the value at t_us on the straight line between two consecutive points, which must have values. */
static inline double history_point_between(const struct history_point *a, const struct history_point *b, int64_t t_us)
{
    return a->value + (b->value - a->value) * ((double)(t_us - a->t_us) / (double)(b->t_us - a->t_us));
}
/* Returns true if a straight line joins `a` to `b`; otherwise the value of `a` holds until `b`. */
static inline bool history_point_joined(const struct history_point *a, const struct history_point *b, bool step)
{
    return !step && history_point_usable(a) && history_point_usable(b) && a->quality == b->quality;
}

/* printf() formats of the texts by which a month's file notes a gap or a step of the clock; the argument is a duration in seconds. */
#define HISTORY_GAP_TEXT "not recorded for %.1f s"
#define HISTORY_FORWARD_TEXT "the clock was set forward by %.1f s"
#define HISTORY_BACK_TEXT "the clock was set back by %.1f s"

#endif
