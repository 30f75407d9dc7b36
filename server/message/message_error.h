/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The refusal of a client's message or query. Pure; any thread. */
#ifndef MESSAGE_MESSAGE_ERROR_H
#define MESSAGE_MESSAGE_ERROR_H
#include "base/refusal.h"

struct message_error {
    const char *code; /* error code of PROTOCOL.md, static */
    char text[REFUSAL_TEXT_BYTES];
    struct refusal refusal; /* code of the refusal; REFUSAL_NONE: an error in the client program, described only by the English text */
    char about[24];         /* type of the refused message; "": unknown */
    int retry_after_s;      /* seconds until the client should retry; 0: not stated */
};

/* Fills the error with a code (static) and a formatted English text, truncated to fit. Leaves `about` unchanged. */
void message_fail(struct message_error *error, const char *code, const char *fmt, ...) __attribute__((format(printf, 3, 4)));
/* Fills the error with a refusal that has no arguments. field: name of the refused member, or NULL. */
void message_refuse(struct message_error *error, const char *code, const char *field, enum refusal_code refusal);
/* Fills the error with a refusal; `args` as for refusal_set(). */
void message_refuse_with(struct message_error *error, const char *code, const char *field, enum refusal_code refusal, const char *args, ...)
    __attribute__((format(printf, 5, 6)));
/* Prefixes the text with "field: ". */
void message_error_within(struct message_error *error, const char *field);

#endif
