/* SPDX-License-Identifier: GPL-3.0-or-later */
/* States of alarms from a core to its renderers, as JSON. Thread: any. */
#ifndef CORELINK_CORE_ALARMS_H
#define CORELINK_CORE_ALARMS_H
#include <jansson.h>

#include "alarm/alarm_service.h"

/* Returns the message with alarms that changed after `since`, the oldest change first; since 0: with all that are not normal. *number:
   of the last change in it. The caller owns it. */
json_t *core_alarms_message(struct alarm_service *service, uint64_t since, int64_t now_utc_ns, uint64_t *number);
/* Adds to such a message, for a core that stands by, the changes of alarms after *row and after a time, for its journal.
   *row: of the last of them. To be called after core_alarms_message(). */
void core_alarms_add_rows(json_t *message, struct alarm_service *service, uint64_t *row, int64_t after_utc_ns);
/* Takes such a message into a service that mirrors. Returns NULL, or what is wrong with it (static); then nothing changed. */
const char *core_alarms_take(struct alarm_service *service, const json_t *message);

#endif
