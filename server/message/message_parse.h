/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses a client's JSON message, according to a table of all message types. Pure. Call from any thread. */
#ifndef MESSAGE_MESSAGE_PARSE_H
#define MESSAGE_MESSAGE_PARSE_H
#include "message/message.h"

/* Parses and checks a message of `count` bytes. Returns false with the refusal in *error. */
bool message_parse(const struct plant *plant, const char *text, size_t count, struct message *out, struct message_error *error);

#endif
