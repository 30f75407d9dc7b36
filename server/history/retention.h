/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Retention of history: deletes the oldest, whole months where they are too old or more is too much, else the oldest part of a month. The
   last minutes always stay. Thread: that of whoever records. */
#ifndef HISTORY_RETENTION_H
#define HISTORY_RETENTION_H
#include <stdbool.h>
#include <stdint.h>

#include "base/log/log.h"

struct retention_limits {
    double days, bytes; /* 0: no limit */
    bool sends;         /* points wait in the files for another database (month_outbox.h): they keep a month from being too old */
};
/* Deletes what is beyond the limits: whole months (logged), and 16 MB at a time of a month. To be called every minute. Returns the size on
   disk of what is left, in bytes. *unsent: how many points were deleted that waited for another database, logged. */
int64_t retention_apply(struct log *log, const char *folder, const struct retention_limits *limits, int64_t now_us, int64_t *unsent);

#endif
