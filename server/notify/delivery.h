/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sends messages by SMTP and HTTP without blocking: one message at a time per recipient, all recipients in parallel. Thread: one, except
   delivery_wake(). */
#ifndef NOTIFY_DELIVERY_H
#define NOTIFY_DELIVERY_H
#include <stdbool.h>

#include "base/log/log.h"
#include "plant/sections/notification.h"

struct delivery;
/* Creates a delivery, which sends to the recipients of `notify`; `notify` must outlive it. Returns NULL if libcurl cannot be used
   (logged). */
struct delivery *delivery_create(struct log *log, const struct plant_notify *notify);
void delivery_destroy(struct delivery **delivery); /* aborts transfers in progress and frees the delivery. &NULL is fine; sets it to NULL */

bool delivery_is_idle(const struct delivery *delivery, int recipient);
/* Starts sending to an idle recipient. Takes ownership of `body` (mem_free). Returns NULL on success, or the reason why sending cannot
   start (free with mem_free()). */
char *delivery_start(struct delivery *delivery, int recipient, char *body, size_t bytes);
/* Waits up to timeout_ms for activity, and calls each() for every delivery that has ended; its `why` is NULL if the message was
   accepted. */
void delivery_wait(struct delivery *delivery, int timeout_ms, void (*each)(void *arg, int recipient, const char *why), void *arg);
void delivery_wake(struct delivery *delivery); /* Ends delivery_wait(); any thread. */

#endif
