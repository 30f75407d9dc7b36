/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Retention of history: deletes whole months that are too old or exceed the size limit, or only the oldest points of a month.
   The last ten minutes are never deleted. All functions except retention_by_age() must run in the recording thread. */
#ifndef HISTORY_RETENTION_H
#define HISTORY_RETENTION_H
#include <stdbool.h>
#include <stdint.h>

#include "base/log/log.h"

struct retention_limits {
    double days, bytes; /* limits on age in days and on size in bytes; 0: no limit */
    /* true: points in the outboxes are sent to PostgreSQL (month_outbox.h); a month with unsent points is kept despite its age */
    bool sends;
};

struct retention_clock {     /* detects a clock that was set far forward; zero-initialise */
    bool was_called;         /* true: retention_by_age() was called */
    int64_t ahead_ns;        /* UTC minus monotonic time at the last call */
    int64_t applies_from_ns; /* monotonic time from which on the limits on age are applied */
    /* UTC time without records for which the limits on age are not applied; both 0: the clock was set while the daemon was running */
    int64_t pause_from_us, pause_to_us;
};

/* Deletes history that exceeds the limits: whole months (logged), or up to 16 MB of a month per call. Call it every minute.
   Returns the remaining size on disk in bytes. *unsent receives the number of points deleted before they were sent to
   PostgreSQL (logged). */
int64_t retention_apply(struct log *log, const char *folder, const struct retention_limits *limits, int64_t now_us, int64_t *unsent);
/* Returns true if history and rows of the alarm journal may be deleted for their age. Returns false for a week of monotonic time after
   the clock was set forward by more than a week since the last call. After the first call, also returns false for a week if the
   history has a pause of more than a week that lasts until utc_ns, ended within the week before, or lies between the newest two
   months: the clock may have been set while the daemon did not run. Does not notice a pause within one month. Call it before each
   deletion, from any thread, with one clock for each thread. */
bool retention_by_age(struct retention_clock *clock, struct log *log, const char *folder, int64_t mono_ns, int64_t utc_ns);
/* Returns the number of days of history that fit the size limit, judged by the newest month with at least a day of history;
   INFINITY: unknown. Logs a warning if limits->days is more. Call it at the start. */
double retention_check(struct log *log, const char *folder, const struct retention_limits *limits);

#endif
