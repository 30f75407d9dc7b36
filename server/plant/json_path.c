/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A path is read step by step, each time that it is walked. */
#include "plant/json_path.h"

#include <stdio.h>
#include <string.h>

const char *json_path_begin(const char *text)
{
    text += *text == '$';
    return text + (*text == '.');
}

/* [0] or ["name"]. */
static bool read_bracket(const char **at, struct json_path_step *out)
{
    const char *p = *at + 1, *end;
    if (*p == '"') {
        end = strchr(p + 1, '"');
        if (!end || end[1] != ']' || end == p + 1)
            return false;
        *out = (struct json_path_step){ .name = p + 1, .length = (size_t)(end - p - 1) };
        *at = end + 2;
        return true;
    }
    size_t digits = strspn(p, "0123456789");
    if (digits == 0 || digits > 6 || p[digits] != ']')
        return false;
    *out = (struct json_path_step){ 0 };
    for (size_t i = 0; i < digits; i++)
        out->index = out->index * 10 + (size_t)(p[i] - '0');
    *at = p + digits + 1;
    return true;
}

bool json_path_next(const char **at, struct json_path_step *out)
{
    const char *p = *at;
    if (*p == '[') {
        if (!read_bracket(&p, out))
            return false;
    } else {
        size_t length = strcspn(p, ".[");
        if (length == 0)
            return false;
        *out = (struct json_path_step){ .name = p, .length = length };
        p += length;
    }
    if (*p == '.' && p[1] && p[1] != '.' && p[1] != '[')
        p++;
    else if (*p == '.')
        return false;
    *at = p;
    return true;
}

bool json_path_check(const char *text, char why[200])
{
    const char *at = json_path_begin(text);
    struct json_path_step step;
    while (*at && json_path_next(&at, &step))
        ;
    if (*at)
        snprintf(why, 200, "expected a path such as data.temperature, items[0].value or [\"odd name\"], found '%.40s'", at);
    return !*at;
}
