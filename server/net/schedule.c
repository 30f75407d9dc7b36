/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whose picture is drawn next. */
#include "net/schedule.h"

#include "base/clock.h"

int64_t schedule_due_ns(enum urgency urgency, int64_t asked_ns)
{
    static const int64_t patience_ns[] = {
        [URGENCY_INPUT] = 0,
        [URGENCY_DATA] = 50 * NS_PER_MS,
        [URGENCY_REFINE] = 400 * NS_PER_MS,
        [URGENCY_SNAPSHOT] = 400 * NS_PER_MS,
    };
    return asked_ns + patience_ns[urgency];
}
