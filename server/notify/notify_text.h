/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Texts of notifications: e-mail (RFC 5322), a webhook's JSON, alerts of Alertmanager's API v2. Pure except for the local time of the
   process's zone. Thread: any. */
#ifndef NOTIFY_NOTIFY_TEXT_H
#define NOTIFY_NOTIFY_TEXT_H
#include "base/text/text.h"
#include "notify/outbox.h"

enum { NOTIFY_LINES = 50 /* maximum number of alarms listed in an e-mail; further ones are only counted */ };

/* Appends a complete e-mail, header and body, with CRLF line ends. now_us: the date in its header. */
void notify_mail_text(struct text *out, const struct plant *plant, const struct notify_recipient *recipient,
                      const struct outbox_message *message, int64_t now_us);
/* Returns the JSON body of the message for a webhook; free with mem_free(). The sibling notify_alerts_text() returns it for
   Alertmanager. */
char *notify_webhook_text(const struct plant *plant, const struct notify_recipient *recipient, const struct outbox_message *message);
char *notify_alerts_text(const struct plant *plant, const struct outbox_message *message, int64_t now_us);

#endif
