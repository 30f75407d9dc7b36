/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How right the machine's clock is: what chrony, ntpd, systemd-timesyncd or a PTP daemon has told the kernel. Thread: any. */
#ifndef BASE_SYSTEM_CLOCK_STATE_H
#define BASE_SYSTEM_CLOCK_STATE_H
#include <stdbool.h>
#include <sys/timex.h>

struct clock_state {
    bool set;       /* something keeps it right */
    double error_s; /* by so much it may be wrong at most; 0: not known, or not set */
    int leap_s;     /* seconds that are added at the end of this month, or taken away: 1, -1 or 0 */
};

struct clock_state clock_state_read(void);
/* Interprets an answer of adjtimex(2). state: what it returned. */
struct clock_state clock_state_of(const struct timex *timex, int state);
/* Returns the next of 1, 10, 100, 1000 ms and so on, so that clients are not told of each small change; 0 for 0. */
int clock_state_error_ms(const struct clock_state *state);

#endif
