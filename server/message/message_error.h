/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A refusal: why the server does not carry out a client's message or HTTP query. Pure; any thread. */
#ifndef MESSAGE_MESSAGE_ERROR_H
#define MESSAGE_MESSAGE_ERROR_H
#include "base/refusal.h"

struct message_error {
    const char *code; /* error code of PROTOCOL.md, static */
    char text[REFUSAL_TEXT_BYTES];
    /* refusal code with arguments, which pages translate for their users; code REFUSAL_NONE: an error of the client program,
       described only by the English text */
    struct refusal refusal;
    char about[24];    /* type of the message that was refused, such as "params"; empty: not known */
    int retry_after_s; /* seconds that the client should wait before it tries again; 0: not stated */
};

/* Sets the error's code (a static text) and its formatted English text, which is truncated if too long. Leaves `about` unchanged. */
void message_fail(struct message_error *error, const char *code, const char *fmt, ...) __attribute__((format(printf, 3, 4)));
/* Sets the error to a refusal code without arguments. field: name of the refused member, or NULL. */
void message_refuse(struct message_error *error, const char *code, const char *field, enum refusal_code refusal);
/* Sets the error to a refusal code with arguments; `args` is a format as for refusal_set(). */
void message_refuse_with(struct message_error *error, const char *code, const char *field, enum refusal_code refusal, const char *args, ...)
    __attribute__((format(printf, 5, 6)));
/* Puts "FIELD: " in front of the error's text, where FIELD is the name of the wrong member. */
void message_error_within(struct message_error *error, const char *field);

#endif
