/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Proving tags in words. Thread: the loop. */
#ifndef MESSAGE_PROVE_MESSAGE_H
#define MESSAGE_PROVE_MESSAGE_H
#include "message/message.h"
#include "loopcheck/loop_checks.h"
#include "value/snapshot.h"

bool prove_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);
/* Judges the tag by its reading now, keeps that, and answers (mem_free). who: of the token. */
char *prove_do(struct loop_checks *loop_checks, const struct plant *plant, const struct snapshot *now, const struct message *message,
               const char *who);
/* All that was ever looked at (since 0), or what was added since; mem_free. */
char *loop_checks_text(const struct loop_checks *loop_checks, const struct plant *plant, uint64_t since, bool all);

#endif
