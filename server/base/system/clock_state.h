/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State of the machine's clock, as reported to the kernel by chrony, ntpd, systemd-timesyncd or a PTP daemon. Call from any thread. */
#ifndef BASE_SYSTEM_CLOCK_STATE_H
#define BASE_SYSTEM_CLOCK_STATE_H
#include <stdbool.h>
#include <sys/timex.h>

struct clock_state {
    bool set;       /* true: a time service synchronises the clock */
    double error_s; /* maximum error of the clock in seconds; 0: unknown, or not synchronised */
    int leap_s;     /* leap seconds to be inserted at the end of this month: 1, -1 or 0 */
};

struct clock_state clock_state_read(void);
/* Interprets the result of adjtimex(2). `state`: the call's return value. */
struct clock_state clock_state_of(const struct timex *timex, int state);
/* Returns the maximum error rounded up to 1, 10, 100, 1000 ms and so on, so that clients need not be notified of small changes;
   0 if the error is 0. */
int clock_state_error_ms(const struct clock_state *state);

#endif
