/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Refusals. */
#include "message/message_error.h"

#include <stdarg.h>
#include <stdio.h>

void message_fail(struct message_error *error, const char *code, const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    error->code = code;
    vsnprintf(error->text, sizeof(error->text), fmt, ap);
    va_end(ap);
}
