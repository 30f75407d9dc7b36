/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The message `prove`, by which a user records a loop check: a test that a value forced at a transmitter arrives as the tag's
   value. Call only in the event loop. */
#ifndef MESSAGE_LOOP_CHECK_MESSAGE_H
#define MESSAGE_LOOP_CHECK_MESSAGE_H
#include "loopcheck/loop_checks.h"
#include "message/message.h"
#include "value/snapshot.h"

/* Parses the message `prove` into out->loop_check. Returns false with *error saying what is wrong. */
bool loop_check_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);
/* Compares the tag's current reading with the expected value and records the result. who: the user's name. Returns the answer;
   free with mem_free(). */
char *loop_check_do(struct loop_checks *loop_checks, const struct plant *plant, const struct snapshot *now, const struct message *message,
                    const char *who);
/* Returns the message `proofs`: the newest loop check of each tag; all false: only checks with sequence numbers
   (loop_checks_number()) above `since`, unless the core has replaced all checks since then. The caller owns it. */
json_t *loop_checks_message(const struct loop_checks *loop_checks, const struct plant *plant, uint64_t since, bool all);
/* Stores the checks of a core's message `proofs`. If the message is invalid, returns false and changes nothing. */
bool loop_checks_take(struct loop_checks *loop_checks, const struct plant *plant, const json_t *message);
/* Returns loop_checks_message() as text. Free with mem_free(). */
char *loop_checks_text(const struct loop_checks *loop_checks, const struct plant *plant, uint64_t since, bool all);

#endif
