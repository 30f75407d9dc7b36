/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Printing JSON. */
#include "base/text/json_text.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/utf8.h"

char *json_text(json_t *value, int digits)
{
    char *dumped = json_dumps(value, JSON_COMPACT | JSON_REAL_PRECISION(digits));
    char *text = mem_strdup(dumped ? dumped : json_is_array(value) ? "[]" : "{}");
    free(dumped);
    json_decref(value);
    return text;
}

json_t *json_of_text(const char *text)
{
    json_t *string = json_string(text);
    if (string)
        return string;
    char *clean = mem_strdup(text);
    for (size_t at = 0, length = strlen(clean), step; at < length; at += step ? step : 1)
        if ((step = utf8_length(clean + at, length - at)) == 0)
            clean[at] = '?';
    string = json_string(clean);
    mem_free(clean);
    return string;
}
