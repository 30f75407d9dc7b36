/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The message `alarm`: acknowledging, shelving and other actions on alarms. Call only in the event loop. */
#ifndef MESSAGE_ALARM_MESSAGE_H
#define MESSAGE_ALARM_MESSAGE_H
#include "alarm/alarm_service.h"
#include "message/message.h"

/* Parses the message into out->alarm. Returns false with *error saying what is wrong. */
bool alarm_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);
/* Carries out the requested action on each alarm of the request whose state allows it. who: the user's name, for the journal.
   Returns the answer, `alarmed`, with the number of changed alarms and the reasons why others were refused; free with
   mem_free(). The caller must check the user's rights. */
char *alarm_do(struct alarm_service *alarm_service, const struct plant *plant, const struct message *message, const char *who);

#endif
