/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a client wants of alarms: read, judged, done. Private to message.c, access.c and session.c. */
#ifndef MESSAGE_ALARM_MESSAGE_H
#define MESSAGE_ALARM_MESSAGE_H
#include "alarm/alarm_service.h"
#include "message/message.h"

bool alarm_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);
/* Does it, as far as each alarm is in a state for it. who: the holder's name. The answer, `alarmed`; mem_free. */
char *alarm_do(struct alarm_service *alarm_service, const struct plant *plant, const struct message *message, const char *who);

#endif
