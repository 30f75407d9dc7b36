/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sends alarm messages by SMTP and HTTP without blocking: one message at a time per recipient, all recipients in parallel. Call
   from one thread only, except delivery_wake(). */
#ifndef NOTIFY_DELIVERY_H
#define NOTIFY_DELIVERY_H
#include <stdbool.h>

#include "base/log/log.h"
#include "plant/sections/notification.h"

struct delivery;
/* Creates an object that sends messages to the recipients of `notify`. `notify` must outlive the object. Returns NULL if
   libcurl cannot be used (logged). */
struct delivery *delivery_create(struct log *log, const struct plant_notify *notify);
/* Aborts messages that are being sent and frees the object; sets *delivery to NULL; accepts a pointer to NULL. */
void delivery_destroy(struct delivery **delivery);

bool delivery_is_idle(const struct delivery *delivery, int recipient);
/* Starts sending a message to an idle recipient. Takes ownership of `body` (mem_free). Returns NULL on success, or the reason why
   sending cannot start (free with mem_free()). */
char *delivery_start(struct delivery *delivery, int recipient, char *body, size_t bytes);
/* Called for a message that was sent or failed. why: NULL if the recipient's server accepted the message, else the reason.
   is_refused: true: the server refuses this message itself (for example its size), so that sending it again is useless.
   refused_mailboxes: number of mailboxes that the mail server refused, although it accepted the mail for others; 0 if the message
   failed. */
typedef void delivery_ended(void *arg, int recipient, const char *why, bool is_refused, int refused_mailboxes);
/* Waits up to timeout_ms for network activity, and calls each() for every message that was sent or failed. */
void delivery_wait(struct delivery *delivery, int timeout_ms, delivery_ended *each, void *arg);
void delivery_wake(struct delivery *delivery); /* Makes delivery_wait() return. Call from any thread. */

#endif
