/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Retention of history: deletes whole months, oldest first, never the newest. */
#ifndef HISTORY_RETENTION_H
#define HISTORY_RETENTION_H
#include <stdint.h>

#include "base/log.h"

struct retention_limits {
    double days, bytes; /* 0: no limit */
};
/* Deletes the months beyond the limits (logged). Returns the size in bytes of those that are left. */
int64_t retention_apply(struct log *log, const char *folder, const struct retention_limits *limits, int64_t now_us);

#endif
