/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Texts of alarm messages: e-mail (RFC 5322), a webhook's JSON, alerts of Alertmanager's API v2. Depends only on the arguments
   and the local time zone. Call from any thread. */
#ifndef NOTIFY_NOTIFY_TEXT_H
#define NOTIFY_NOTIFY_TEXT_H
#include "base/text/text.h"
#include "notify/outbox.h"

enum { NOTIFY_LINES = 50 /* maximum number of alarms that an e-mail lists; further ones are only counted */ };

/* Returns the message in the format of the recipient's kind, and its length in *bytes; free with mem_free(). now_us: time for the
   e-mail's Date header, and from which Alertmanager keeps an alarm OUTBOX_ALERT_US. */
char *notify_text(const struct plant *plant, const struct notify_recipient *recipient, const struct outbox_message *message, int64_t now_us,
                  size_t *bytes);
/* Appends a complete e-mail, header and body, with the alarms of a message. Line ends are CRLF. now_us: time for the Date header. */
void notify_mail_text(struct text *out, const struct plant *plant, const struct notify_recipient *recipient,
                      const struct outbox_message *message, int64_t now_us);
/* Returns the JSON body of a webhook message; free with mem_free(). notify_alerts_text() returns that of a message for Alertmanager. */
char *notify_webhook_text(const struct plant *plant, const struct notify_recipient *recipient, const struct outbox_message *message);
char *notify_alerts_text(const struct plant *plant, const struct outbox_message *message, int64_t now_us);

#endif
