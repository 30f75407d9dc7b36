/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Error texts for messages refused by the server. */
#include "message/message_error.h"

#include <stdarg.h>
#include <stdio.h>

#include "base/text/utf8.h"

void message_fail(struct message_error *error, const char *code, const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    error->code = code;
    error->refusal = (struct refusal){ .code = REFUSAL_NONE };
    vsnprintf(error->text, sizeof(error->text), fmt, ap);
    utf8_drop_invalid(error->text);
    va_end(ap);
}

static void set_text(struct message_error *error, const char *code, const char *field)
{
    error->code = code;
    refusal_text(&error->refusal, error->text);
    if (field)
        message_error_within(error, field);
}

void message_refuse(struct message_error *error, const char *code, const char *field, enum refusal_code refusal)
{
    error->refusal = (struct refusal){ .code = refusal };
    set_text(error, code, field);
}

void message_refuse_with(struct message_error *error, const char *code, const char *field, enum refusal_code refusal, const char *args, ...)
{
    va_list ap;
    va_start(ap, args);
    error->refusal.code = refusal;
    vsnprintf(error->refusal.args, sizeof(error->refusal.args), args, ap);
    utf8_drop_invalid(error->refusal.args);
    va_end(ap);
    set_text(error, code, field);
}

void message_error_within(struct message_error *error, const char *field)
{
    char text[REFUSAL_TEXT_BYTES];
    snprintf(text, sizeof(text), "%s", error->text);
    snprintf(error->text, sizeof(error->text), "%s: %.*s", field, (int)(sizeof(text) - sizeof(error->about) - 3), text);
    utf8_drop_invalid(error->text);
}
