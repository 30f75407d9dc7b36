/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The condition of an alarm: a limit with a deadband, and with delays before it becomes active (on delay) and inactive (off
   delay). Changes depend only on the samples and their times, not on how often the condition is evaluated. No input or output;
   times are monotonic. Call from any thread. */
#ifndef ALARM_CONDITION_H
#define ALARM_CONDITION_H
#include <stdbool.h>
#include <stdint.h>

#include "value/alarm.h"

struct condition { /* zero-initialised: an inactive condition without a running delay */
    bool active;
    /* which delay is running: none, the on delay (before the condition becomes active), or the off delay. CONDITION_SUSPENDED: the
       on delay has stopped while the tag's value is unknown, and continues with the next known value */
    enum { CONDITION_RESTS, CONDITION_COMES, CONDITION_GOES, CONDITION_SUSPENDED } pending;
    int64_t since_ns; /* monotonic time when the running delay began, moved forward by the time for which it was suspended */
    int64_t used_ns;  /* CONDITION_SUSPENDED: time that had passed of the on delay */
};

struct condition_delays {
    int64_t on_ns, off_ns;
};

enum condition_side { CONDITION_CLEAR, CONDITION_BETWEEN /* within the deadband of the limit */, CONDITION_BEYOND };

/* Compares a value with the limit of an alarm. Returns whether the value is beyond the limit, safely within the limit, or in between
   (within the deadband of the limit). */
enum condition_side condition_side(enum alarm_kind kind, double limit, double deadband, double value);
/* Ends a delay that is over at now_ns. Returns true if one ended, so that the condition changed; *at_ns receives the time when
   it was over. */
bool condition_advance(struct condition *condition, const struct condition_delays *delays, int64_t now_ns, int64_t *at_ns);
/* Applies a sample to the condition. side: side of the limit on which the sample's value lies. Call condition_advance() with
   the sample's time first. Returns true if the condition changed. */
bool condition_put(struct condition *condition, const struct condition_delays *delays, enum condition_side side, int64_t now_ns);
/* The tag's value is unknown from now_ns on: suspends a running on delay, and cancels a running off delay, so that no alarm clears
   before its value has been inside the limit for the whole off delay. */
void condition_hold(struct condition *condition, int64_t now_ns);
bool condition_is_timed(const struct condition *condition); /* returns true if the condition can change by the passing of time alone */

#endif
