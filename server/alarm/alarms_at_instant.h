/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which alarms readings of the past had: as the journal says, or, before it began, by their limits. */
#ifndef ALARM_ALARMS_AT_INSTANT_H
#define ALARM_ALARMS_AT_INSTANT_H
#include "base/log.h"
#include "history/history.h"
#include "plant/plant.h"
#include "value/snapshot.h"

/* Of snapshot->taken_utc_ns; none while nothing was recorded, since nobody knows. folder: of the journal; reader: of the history beside
   it. 0 or -errno, logged. Thread: that of the reader. */
int alarms_at_instant(struct log *log, struct history_reader *reader, const char *folder, const struct plant *plant,
                      struct snapshot *snapshot);

#endif
