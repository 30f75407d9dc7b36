/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/refusal.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/text/utf8.h"

#define REFUSAL_ROW(name, code, text) { code, text },
static const struct {
    const char *code, *text;
} rows[REFUSALS] = { { "", "" }, REFUSED_WORDS(REFUSAL_ROW) };

void refusal_set(struct refusal *refusal, enum refusal_code code, const char *args, ...)
{
    va_list ap;
    va_start(ap, args);
    refusal->code = code;
    vsnprintf(refusal->args, sizeof(refusal->args), args, ap);
    utf8_drop_invalid(refusal->args);
    va_end(ap);
}

const char *refusal_words(enum refusal_code code)
{
    return rows[code].text;
}

/* Returns the value of a refusal's argument; "" if the refusal has no such argument. */
static const char *value_of(const struct refusal *refusal, const char *name, size_t name_bytes, size_t *bytes)
{
    for (const char *line = refusal->args; *line; line += strcspn(line, "\n"), line += *line == '\n')
        if (!strncmp(line, name, name_bytes) && line[name_bytes] == '=') {
            *bytes = strcspn(line + name_bytes + 1, "\n");
            return line + name_bytes + 1;
        }
    *bytes = 0;
    return "";
}

void refusal_text(const struct refusal *refusal, char out[REFUSAL_TEXT_BYTES])
{
    size_t used = 0;
    for (const char *at = rows[refusal->code].text; *at && used < REFUSAL_TEXT_BYTES - 1;) {
        size_t bytes = strcspn(at, "{"), name_bytes = strcspn(at + bytes, "}");
        used += (size_t)snprintf(out + used, REFUSAL_TEXT_BYTES - used, "%.*s", (int)bytes, at);
        at += bytes;
        if (*at != '{' || used >= REFUSAL_TEXT_BYTES - 1)
            continue;
        const char *value = value_of(refusal, at + 1, name_bytes - 1, &bytes);
        used += (size_t)snprintf(out + used, REFUSAL_TEXT_BYTES - used, "%.*s", (int)bytes, value);
        at += name_bytes + 1;
    }
    out[used < REFUSAL_TEXT_BYTES ? used : REFUSAL_TEXT_BYTES - 1] = 0;
}

json_t *refusal_json(const struct refusal *refusal)
{
    if (refusal->code == REFUSAL_NONE)
        return NULL;
    json_t *args = json_object();
    char name[32];
    for (const char *line = refusal->args, *end; *line; line = end + (*end == '\n')) {
        end = line + strcspn(line, "\n");
        size_t name_bytes = strcspn(line, "=");
        if (name_bytes >= sizeof(name) || line + name_bytes >= end)
            continue;
        snprintf(name, sizeof(name), "%.*s", (int)name_bytes, line);
        const char *value = line + name_bytes + 1;
        json_object_set_new(args, name, json_stringn(value, (size_t)(end - value)));
    }
    return json_pack("{s:s,s:o}", "code", rows[refusal->code].code, "args", args);
}

static void add_refusal(json_t *answer, const char *text, const char *member, const struct refusal *refusal)
{
    char words[REFUSAL_TEXT_BYTES];
    refusal_text(refusal, words);
    json_object_set_new(answer, text, json_string(words));
    if (refusal->code != REFUSAL_NONE)
        json_object_set_new(answer, member, refusal_json(refusal));
}

void refusal_add(json_t *answer, enum refusal_code code)
{
    add_refusal(answer, "why", "refusal", &(struct refusal){ .code = code });
}

void refusal_add_with(json_t *answer, const struct refusal *refusal)
{
    add_refusal(answer, "why", "refusal", refusal);
}

void refusal_add_unaudited(json_t *answer, enum refusal_code code)
{
    add_refusal(answer, "unaudited", "unaudited_refusal", &(struct refusal){ .code = code });
}
