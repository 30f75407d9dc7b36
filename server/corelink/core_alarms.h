/* SPDX-License-Identifier: GPL-3.0-or-later */
/* States of alarms from a core to its renderers, as JSON. Thread: any. */
#ifndef CORELINK_CORE_ALARMS_H
#define CORELINK_CORE_ALARMS_H
#include <jansson.h>

#include "alarm/alarm_service.h"

/* Returns the message with alarms that changed after `since`, the oldest change first; since 0: all alarms that are not normal. *number:
   sequence number of the last change in the message. The caller owns the message. */
json_t *core_alarms_message(struct alarm_service *service, uint64_t since, int64_t now_utc_ns, uint64_t *number);
/* For a standby core's journal, adds the alarm changes after journal row *row and after a time to the message. Sets *row to the last row
   added. Call it after core_alarms_message(). */
void core_alarms_add_rows(json_t *message, struct alarm_service *service, uint64_t *row, int64_t after_utc_ns);
/* Applies the message of core_alarms_message() to a mirroring alarm service. Returns NULL, or what is wrong with the message (static);
   then nothing changed. */
const char *core_alarms_take(struct alarm_service *service, const json_t *message);

#endif
