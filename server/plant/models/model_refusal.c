/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Formats the text that says why a model file is rejected. */
#include "plant/models/model_refusal.h"

#include <stdarg.h>
#include <stdio.h>

#include "base/text/utf8.h"

bool wrong(char why[MODEL_WHY_BYTES], const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(why, MODEL_WHY_BYTES, fmt, ap);
    va_end(ap);
    utf8_drop_invalid(why); /* a shortened name may end inside a character, which JSON does not allow */
    return false;
}
