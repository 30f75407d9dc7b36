/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the value that a path (plant/sources/json_path.h) selects in a JSON document. No side effects. Call from any thread. */
#ifndef VALUE_MQTT_JSON_SELECT_H
#define VALUE_MQTT_JSON_SELECT_H
#include <jansson.h>
#include <stddef.h>

struct json_selected {
    size_t count;         /* number of values in the JSON document that the path selects */
    const json_t *value;  /* last selected value; NULL: none */
    const json_t *holder; /* object or array that contains `value`; NULL: `value` is the root */
    /* If the path addresses an array item by position: a name stated in the item that does not match the tag; NULL: there is no
       such name. */
    const json_t *foreign;
};

/* Follows the path from `root`. tag: name of the tag whose value is read. An array item that the path addresses by position may
   state a name (a text or number called `id`, `name`, `tag` and the like). It is then selected only if this is the tag's name,
   or ends in it after a separator. The reason: items of a publisher that sends only changed ones have changing positions. */
struct json_selected json_select(const json_t *root, const char *path, const char *tag);

#endif
