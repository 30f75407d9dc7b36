/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The refusal of a client's message or query. Pure; any thread. */
#ifndef MESSAGE_MESSAGE_ERROR_H
#define MESSAGE_MESSAGE_ERROR_H

struct message_error {
    const char *code; /* of PROTOCOL.md, static */
    char text[240];
    char about[24];    /* type of the message that is refused; "": unknown */
    int retry_after_s; /* when to try again; 0: not said */
};

/* Fills the error with a code (static) and a formatted text, which is cut to fit. Leaves `about` as it is. */
void message_fail(struct message_error *error, const char *code, const char *fmt, ...) __attribute__((format(printf, 3, 4)));

#endif
