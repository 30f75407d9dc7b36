/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rate limit for log lines about one repeating state: counts the suppressed lines, and doubles the pause until the next line. */
#include "base/log/log_pace.h"

#include <stdio.h>

static void start_pause(struct log_pace *pace, int64_t now_ns)
{
    pace->pause_ns = pace->pause_ns ? 2 * pace->pause_ns : pace->first_ns;
    if (pace->pause_ns > pace->longest_ns)
        pace->pause_ns = pace->longest_ns;
    pace->next_ns = now_ns + pace->pause_ns;
    pace->unsaid = 0;
}

static void write_count(const struct log_pace *pace, char more[LOG_PACE_BYTES])
{
    *more = 0;
    if (pace->unsaid > 0)
        snprintf(more, LOG_PACE_BYTES, " (and %ld more in the last %lld s)", pace->unsaid, (long long)(pace->pause_ns / 1000000000));
}

bool log_pace_take(struct log_pace *pace, int64_t now_ns, char more[LOG_PACE_BYTES])
{
    if (pace->next_ns && now_ns < pace->next_ns) {
        pace->unsaid++;
        return false;
    }
    write_count(pace, more);
    start_pause(pace, now_ns);
    return true;
}

bool log_pace_flush(struct log_pace *pace, int64_t now_ns, char more[LOG_PACE_BYTES])
{
    if (pace->unsaid == 0 || now_ns < pace->next_ns)
        return false;
    write_count(pace, more);
    start_pause(pace, now_ns);
    return true;
}
