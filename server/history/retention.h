/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How long history is kept: whole months go, oldest first, never the newest. */
#ifndef HISTORY_RETENTION_H
#define HISTORY_RETENTION_H
#include <stdint.h>

#include "base/log.h"

struct retention_limits {
    double days, bytes; /* 0: no limit */
};
/* Deletes what is beyond the limits, and says so. Returns how many bytes the months that are left take. */
int64_t retention_apply(struct log *log, const char *folder, const struct retention_limits *limits, int64_t now_us);

#endif
