/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints JSON as text, and gets texts from JSON objects. Call from any thread. */
#ifndef BASE_TEXT_JSON_TEXT_H
#define BASE_TEXT_JSON_TEXT_H
#include <jansson.h>

/* Prints a JSON value and takes ownership of the value. The text has no spaces; numbers have `digits` significant digits (0: all).
   Returns "{}" or "[]" if the value cannot be printed; free the text with mem_free(). */
char *json_text(json_t *value, int digits);

/* Returns a JSON string. Bytes of `text` that are not UTF-8 become '?', because paths and shortened names may contain them. */
json_t *json_of_text(const char *text);

/* Returns the text of an object's member, owned by the object; NULL: there is no such member, or it is not a text. */
static inline const char *json_member_text(const json_t *object, const char *key)
{
    return json_string_value(json_object_get(object, key));
}

#endif
