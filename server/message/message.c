/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks shared by several messages. */
#include "message/message.h"

#include <math.h>

#include "base/text/timestamp.h"

bool message_take_time(const char *name, const char *text, int64_t now_us, int64_t *out, struct message_error *error)
{
    if (timestamp_parse(text, now_us, out))
        return true;
    message_fail(error, "bad_field", "%s: expected " TIMESTAMP_FORMS ", found '%.60s'", name, text);
    return false;
}

bool view_size_valid(double w, double h)
{
    return w >= 16 && h >= 16 && w <= VIEW_MAX_SIDE_PX && h <= VIEW_MAX_SIDE_PX && w * h <= VIEW_MAX_PIXELS && w == floor(w) &&
           h == floor(h);
}
