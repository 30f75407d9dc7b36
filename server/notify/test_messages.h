/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Test messages: let an engineer check the mail server, addresses, passwords and URLs of the plant file's `notify` without an alarm. */
#ifndef NOTIFY_TEST_MESSAGES_H
#define NOTIFY_TEST_MESSAGES_H
#include <stdio.h>

#include "base/log/log.h"
#include "plant/plant.h"

/* Sends one test message of priority 1 to each recipient of plant->notify, which must not be NULL, and waits for the result,
   at most notify->timeout_s. Ignores rules. Writes one line for each recipient to `out`, and logs the mailboxes that a mail server
   refused. Returns the number of recipients whose server did not accept the message, plus the number of refused mailboxes; -1 if
   libcurl cannot be used (logged). */
int test_messages_send(struct log *log, const struct plant *plant, FILE *out);

#endif
