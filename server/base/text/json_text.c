/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Printing JSON. */
#include "base/text/json_text.h"

#include <stdlib.h>

#include "base/mem.h"

char *json_text(json_t *value, int digits)
{
    char *dumped = json_dumps(value, JSON_COMPACT | JSON_REAL_PRECISION(digits));
    char *text = mem_strdup(dumped ? dumped : json_is_array(value) ? "[]" : "{}");
    free(dumped);
    json_decref(value);
    return text;
}
