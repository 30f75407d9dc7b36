/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Follows a path through a JSON document, and counts the values that the path selects. */
#include "value/mqtt/json_select.h"

#include <stdbool.h>
#include <string.h>
#include <strings.h>

#include "plant/sources/json_path.h"

static const json_t *item_at(const json_t *array, long index)
{
    size_t count = json_array_size(array);
    if (index >= 0)
        return json_array_get(array, (size_t)index);
    return (size_t)-index <= count ? json_array_get(array, count - (size_t)-index) : NULL;
}

/* --- array items that state their own name ---------------------------------------------------------------------------------- */

static bool names_its_object(const char *key)
{
    static const char *const keys[] = { "id",     "name",     "tag",       "tagname", "tag_name", "tagid",   "tag_id",
                                        "key",    "n",        "metric",    "signal",  "variable", "point",   "channel",
                                        "sensor", "sensorid", "sensor_id", "node",    "nodeid",   "node_id", "address" };
    for (size_t i = 0; i < sizeof(keys) / sizeof(*keys); i++)
        if (!strcasecmp(key, keys[i]))
            return true;
    return false;
}

/* Returns true if the name stated in an array item is the tag's name, or ends in it after a separator, such as `A.T1` for the tag T1. */
static bool is_name_of(const json_t *name, const char *tag)
{
    const char *text = json_string_value(name);
    size_t length = text ? strlen(text) : 0, tag_length = strlen(tag);
    if (!text || length < tag_length || strcmp(text + length - tag_length, tag) != 0)
        return false;
    return length == tag_length || strchr("./:\\!|", text[length - tag_length - 1]);
}

/* Returns true if the rest of a path selects the member `key` of an array item. That member then holds the tag's value rather
   than a name of the item. */
static bool is_selected(const char *key, const char *rest)
{
    struct json_path_step step;
    char why[200];
    return *rest && json_path_next(&rest, &step, why) && step.kind == JSON_PATH_NAME && !strcmp(step.name, key);
}

/* Returns a name stated in an array item if no such name matches the tag; NULL if one matches or the item states none. rest:
   path below the item. */
static const json_t *foreign_name(const json_t *item, const char *tag, const char *rest)
{
    const char *key;
    json_t *member;
    const json_t *name = NULL;
    json_object_foreach((json_t *)item, key, member)
    {
        if (!names_its_object(key) || !(json_is_string(member) || json_is_number(member)) || is_selected(key, rest))
            continue;
        if (is_name_of(member, tag))
            return NULL;
        name = name ? name : member;
    }
    return name;
}

/* --- filters ---------------------------------------------------------------------------------------------------------------- */

static const json_t *operand_of(const json_t *item, const struct json_path_test *test)
{
    struct json_path_step step;
    char why[200];
    for (const char *at = test->path; item && at < test->end;) {
        if (!json_path_next_operand(&at, &step, why))
            return NULL;
        item = step.kind == JSON_PATH_NAME ? json_object_get(item, step.name) : item_at(item, step.index);
    }
    return item;
}

static bool holds(const json_t *item, const struct json_path_test *test)
{
    const json_t *value = operand_of(item, test);
    switch (test->kind) {
    case JSON_LITERAL_STRING: return json_is_string(value) && !strcmp(json_string_value(value), test->text);
    case JSON_LITERAL_NUMBER: return json_is_number(value) && json_number_value(value) == test->number;
    case JSON_LITERAL_TRUE: return json_is_true(value);
    case JSON_LITERAL_FALSE: return json_is_false(value);
    case JSON_LITERAL_NULL: return json_is_null(value);
    }
    return false;
}

static bool all_hold(const json_t *item, const struct json_path_step *step)
{
    for (int i = 0; i < step->test_count; i++)
        if (!holds(item, &step->tests[i]))
            return false;
    return true;
}

/* --- walking a path --------------------------------------------------------------------------------------------------------- */

static void walk(const json_t *value, const json_t *holder, const char *at, const char *tag, struct json_selected *out);

static void walk_matches(const json_t *holder, const struct json_path_step *step, const char *at, const char *tag,
                         struct json_selected *out)
{
    const char *key;
    json_t *item;
    size_t i;
    json_array_foreach((json_t *)holder, i, item)
    {
        if (all_hold(item, step))
            walk(item, holder, at, tag, out);
    }
    json_object_foreach((json_t *)holder, key, item)
    {
        if (all_hold(item, step))
            walk(item, holder, at, tag, out);
    }
}

/* Selects the values below `value` by the path from `at` on. Recursive: the depth is the number of steps in the path, which the
 * maximum length of a tag's address limits. */
static void walk(const json_t *value, const json_t *holder, const char *at, const char *tag, struct json_selected *out)
{
    struct json_path_step step;
    char why[200];
    if (!*at) {
        out->count++;
        out->value = value;
        out->holder = holder;
        return;
    }
    if (!json_path_next(&at, &step, why))
        return;
    if (step.kind == JSON_PATH_FILTER) {
        walk_matches(value, &step, at, tag, out);
        return;
    }
    const json_t *child = step.kind == JSON_PATH_NAME ? json_object_get(value, step.name) : item_at(value, step.index);
    const json_t *foreign = child && step.kind == JSON_PATH_INDEX ? foreign_name(child, tag, at) : NULL;
    if (foreign)
        out->foreign = foreign;
    else if (child)
        walk(child, value, at, tag, out);
}

struct json_selected json_select(const json_t *root, const char *path, const char *tag)
{
    struct json_selected out = { 0 };
    if (root)
        walk(root, NULL, json_path_begin(path), tag, &out);
    return out;
}
