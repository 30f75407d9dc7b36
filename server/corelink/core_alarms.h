/* SPDX-License-Identifier: GPL-3.0-or-later */
/* JSON messages with alarm states from a core to its renderers and its standby. Call from any thread. */
#ifndef CORELINK_CORE_ALARMS_H
#define CORELINK_CORE_ALARMS_H
#include <jansson.h>

#include "alarm/alarm_service.h"

/* Returns a message with the alarms whose change number is greater than `since`, oldest change first; since 0: all alarms that
   are not normal. *number receives the newest change number in the message. The caller owns the message. */
json_t *core_alarms_message(struct alarm_service *service, uint64_t since, int64_t now_utc_ns, uint64_t *number);
/* For the journal of a standby core: adds the journal rows whose number is greater than *row to the message, and sets *row to
   the number of the last one. Call it after core_alarms_message(). */
void core_alarms_add_rows(json_t *message, struct alarm_service *service, uint64_t *row);
/* Applies a message of core_alarms_message() to an alarm service that mirrors a core. Returns NULL, or what is wrong with the
   message (static text) if nothing was changed. */
const char *core_alarms_take(struct alarm_service *service, const json_t *message);

#endif
