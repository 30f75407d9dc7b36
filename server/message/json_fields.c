/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads members of a JSON object and checks their type and range. */
#include "message/json_fields.h"

#include <math.h>
#include <string.h>

#include "base/text/utf8.h"

const char *quoted(const char *text, char out[48])
{
    enum { MOST_BYTES = 40 };
    size_t n = 0, at = 0, left = strnlen(text, MOST_BYTES + 4);
    while (at < left) {
        const unsigned char *c = (const unsigned char *)text + at;
        size_t step = utf8_length(text + at, left - at);
        /* true: a control character (C0, DEL or C1), which the quoted text shows as ? */
        bool control = c[0] < 32 || c[0] == 127 || (c[0] == 0xC2 && c[1] < 0xA0);
        if (n + (step && !control ? step : 1) > MOST_BYTES)
            break;
        if (step && !control)
            memcpy(out + n, text + at, step);
        else
            out[n] = '?';
        n += step && !control ? step : 1;
        at += step ? step : 1;
    }
    strcpy(out + n, text[at] ? "..." : "");
    return out;
}

static bool in_range(const json_t *value, double low, double high)
{
    double number = json_number_value(value);
    return json_is_number(value) && isfinite(number) && number >= low && number <= high;
}

bool may_number(const json_t *o, const char *name, double low, double high, double *out, bool *given, struct message_error *error)
{
    const json_t *value = json_object_get(o, name);
    if (given)
        *given = value != NULL;
    if (!value)
        return true;
    if (!in_range(value, low, high)) {
        message_refuse_with(error, "bad_field", name, REFUSAL_BETWEEN, "low=%g\nhigh=%g", low, high);
        return false;
    }
    *out = json_number_value(value);
    return true;
}

bool need_number(const json_t *o, const char *name, double low, double high, double *out, struct message_error *error)
{
    bool given;
    if (!may_number(o, name, low, high, out, &given, error))
        return false;
    if (!given)
        message_fail(error, "bad_field", "%s is missing: expected a number from %g to %g", name, low, high);
    return given;
}

bool need_seq(const json_t *o, uint32_t *out, struct message_error *error)
{
    const json_t *value = json_object_get(o, "seq");
    if (!json_is_integer(value) || json_integer_value(value) < 1 || json_integer_value(value) > UINT32_MAX) {
        message_fail(error, "bad_field", "seq: expected the number of a message or frame, a whole number from 1 to 4294967295");
        return false;
    }
    *out = (uint32_t)json_integer_value(value);
    return true;
}

bool may_vector(const json_t *o, const char *name, double out[3], bool *given, struct message_error *error)
{
    const json_t *array = json_object_get(o, name);
    if (given)
        *given = array != NULL;
    if (!array)
        return true;
    for (size_t i = 0; i < 3; i++)
        if (json_array_size(array) != 3 || !in_range(json_array_get(array, i), -PLANT_MAX_M, PLANT_MAX_M)) {
            message_fail(error, "bad_field", "%s: expected three numbers within +-%g", name, PLANT_MAX_M);
            return false;
        }
    for (size_t i = 0; i < 3; i++)
        out[i] = json_number_value(json_array_get(array, i));
    return true;
}

bool need_vector(const json_t *o, const char *name, double out[3], struct message_error *error)
{
    bool given;
    if (!may_vector(o, name, out, &given, error))
        return false;
    if (!given)
        message_fail(error, "bad_field", "%s is missing: expected three numbers", name);
    return given;
}

static bool is_printable(const char *text)
{
    while (*text > 32 && *text < 127)
        text++;
    return *text == 0;
}

bool may_text(const json_t *o, const char *name, char *out, size_t size, bool *given, struct message_error *error)
{
    const json_t *value = json_object_get(o, name);
    const char *text = json_string_value(value);
    if (given)
        *given = value != NULL;
    if (!value)
        return true;
    if (!text || !text[0] || json_string_length(value) >= size || strlen(text) != json_string_length(value) || !is_printable(text)) {
        message_fail(error, "bad_field", "%s: expected a text of 1 to %zu characters without spaces", name, size - 1);
        return false;
    }
    strcpy(out, text);
    return true;
}

bool may_name(const json_t *o, const char *name, const struct name *names, int *out, bool *given, struct message_error *error)
{
    const json_t *value = json_object_get(o, name);
    *given = value != NULL;
    if (!value)
        return true;
    int found = json_is_string(value) ? name_find(names, json_string_value(value)) : -1;
    if (found >= 0) {
        *out = found;
        return true;
    }
    char list[120] = "";
    for (const struct name *n = names; n->text; n++)
        snprintf(list + strlen(list), sizeof(list) - strlen(list), "%s'%s'", n == names ? "" : ", ", n->text);
    message_fail(error, "bad_field", "%s: expected one of %s", name, list);
    return false;
}

bool has_controls(const char *text)
{
    static const char *const overrides[] = { "\u202a", "\u202b", "\u202c", "\u202d", "\u202e", "\u2066", "\u2067", "\u2068", "\u2069" };
    for (const unsigned char *c = (const unsigned char *)text; *c; c++)
        if (*c < 32 || *c == 127 || (*c == 0xc2 && c[1] >= 0x80 && c[1] < 0xa0)) /* control characters (C0 and C1) */
            return true;
    for (size_t i = 0; i < sizeof(overrides) / sizeof(overrides[0]); i++)
        if (strstr(text, overrides[i]))
            return true;
    return false;
}

bool need_words(const json_t *o, const char *name, bool needed, char *out, size_t size, struct message_error *error)
{
    const json_t *value = json_object_get(o, name);
    const char *text = json_string_value(value);
    bool good = text ? json_string_length(value) < size && strlen(text) == json_string_length(value) : !value;
    good = good && !(text && has_controls(text)) && (!needed || (text && text[strspn(text, " ")]));
    if (good)
        snprintf(out, size, "%s", text ? text : "");
    else
        message_refuse_with(error, "bad_field", name, REFUSAL_TEXT_EXPECTED, "least=%d\nbytes=%zu", needed, size - 1);
    return good;
}
