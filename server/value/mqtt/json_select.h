/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the one value that a path (plant/sources/json_path.h) selects in a JSON document. Pure. Thread: any. */
#ifndef VALUE_MQTT_JSON_SELECT_H
#define VALUE_MQTT_JSON_SELECT_H
#include <jansson.h>
#include <stddef.h>

struct json_selected {
    size_t count;          /* how many values the path selects */
    const json_t *value;   /* the last of them; NULL: none */
    const json_t *holder;  /* the object or array that contains value; NULL: value is the root */
    const json_t *foreign; /* an item at a position in the path names itself, and not as `tag`; this is its name. NULL: none does */
};

/* Walks the path from root. tag: name of the tag whose value is looked for; an array's item that names itself (a text or number called
   `id`, `name`, `tag` and the like) and was addressed by its position is not selected unless its name is the tag's, or ends in the tag's
   behind a separator: publishers that send only what has changed move their items. */
struct json_selected json_select(const json_t *root, const char *path, const char *tag);

#endif
