/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Alarms at a past time: from the alarm journal or, for times before the journal begins, from the current limits. */
#ifndef ALARM_ALARMS_AT_INSTANT_H
#define ALARM_ALARMS_AT_INSTANT_H
#include "base/log/log.h"
#include "history/history.h"
#include "plant/plant.h"
#include "value/snapshot.h"

/* Sets the alarms in a historical snapshot to those at the time snapshot->taken_utc_ns; sets none if nothing was recorded at
   that time. folder: folder of the alarm journal; reader: reader of the history in that folder. Returns 0 or -errno (logged).
   Call only in the reader's thread. */
int alarms_at_instant(struct log *log, struct history_reader *reader, const char *folder, const struct plant *plant,
                      struct snapshot *snapshot);

#endif
