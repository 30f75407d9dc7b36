/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Retention of history: deletes whole months that are too old or exceed the size limit, or only the oldest points of a month.
   The last ten minutes are never deleted. Call only in the recording thread. */
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
/* Deletes history that exceeds the limits: whole months (logged), or up to 16 MB of a month per call. Call it every minute.
   Returns the remaining size on disk in bytes. *unsent receives the number of points deleted before they were sent to
   PostgreSQL (logged). */
int64_t retention_apply(struct log *log, const char *folder, const struct retention_limits *limits, int64_t now_us, int64_t *unsent);
/* Returns the number of days of history that fit the size limit, judged by the newest month with at least a day of history;
   INFINITY: unknown. Logs a warning if limits->days is more. Call it at the start. */
double retention_check(struct log *log, const char *folder, const struct retention_limits *limits);

#endif
