/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whether the cause of an alarm is there: a limit with its deadband, held against a delay. When it comes and goes depends on the
   samples and their times alone, not on how often anybody looks. Pure; times are monotonic. Thread: any. */
#ifndef ALARM_CONDITION_H
#define ALARM_CONDITION_H
#include <stdbool.h>
#include <stdint.h>

#include "value/alarm.h"

struct condition { /* zero-initialised: not there */
    bool active;
    enum { CONDITION_RESTS, CONDITION_COMES, CONDITION_GOES } pending; /* a delay runs */
    int64_t since_ns; /* when it began to */
};

struct condition_delays {
    int64_t on_ns, off_ns;
};

enum condition_side { CONDITION_CLEAR, CONDITION_BETWEEN /* within the deadband */, CONDITION_BEYOND };

/* On which side of its limit a value is. */
enum condition_side condition_side(enum alarm_kind kind, double limit, double deadband, double value);
/* Time passes. True: it came or went, at *at_ns. */
bool condition_advance(struct condition *condition, const struct condition_delays *delays, int64_t now_ns, int64_t *at_ns);
/* A sample, after condition_advance to its time. True: it came or went with it. */
bool condition_put(struct condition *condition, const struct condition_delays *delays, enum condition_side side, int64_t now_ns);
void condition_hold(struct condition *condition); /* nothing is known from now on: no delay runs out meanwhile */

#endif
