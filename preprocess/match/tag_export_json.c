/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ignition's export: folders and UDT instances hold tags, tags hold properties. */
#include <jansson.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "preprocess/match/tag_export.h"

enum { MAX_DEPTH = 64 };

static const struct property {
    const char *name;
    enum export_field field;
} properties[] = {
    { "name", EXPORT_NAME },
    { "opcItemPath", EXPORT_ADDRESS },
    { "dataType", EXPORT_TYPE },
    { "scaleMode", EXPORT_SCALING },
    { "rawLow", EXPORT_RAW_LOW },
    { "rawHigh", EXPORT_RAW_HIGH },
    { "scaledLow", EXPORT_SCALED_LOW },
    { "scaledHigh", EXPORT_SCALED_HIGH },
    { "engLow", EXPORT_SCALED_LOW },
    { "engHigh", EXPORT_SCALED_HIGH },
    { "engUnit", EXPORT_UNIT },
    { "documentation", EXPORT_DESCRIPTION },
    { "tooltip", EXPORT_DESCRIPTION },
    { "opcServer", EXPORT_DEVICE },
};

/* Text without control characters; numbers as they are; a binding is an object whose "binding" is the text. */
static void set_from_json(struct tag_export *list, struct export_tag *tag, enum export_field field, json_t *value)
{
    char number[64];
    if (json_is_object(value))
        value = json_object_get(value, "binding");
    if (json_is_number(value)) {
        snprintf(number, sizeof(number), "%.12g", json_number_value(value));
        export_tag_set(tag, field, number);
    } else if (json_is_string(value)) {
        char *copy = mem_strdup(json_string_value(value));
        for (char *c = copy; *c; c++)
            if ((unsigned char)*c < 32 || *c == 127) {
                *c = ' ';
                list->control++;
            }
        char *from = copy + strspn(copy, " "), *end = from + strlen(from);
        while (end > from && end[-1] == ' ')
            *--end = 0;
        export_tag_set(tag, field, from);
        mem_free(copy);
    }
}

static bool add_tags(struct tag_export *list, json_t *node, const char *path, int depth)
{
    json_t *inner = json_object_get(node, "tags"), *item;
    const char *name = json_string_value(json_object_get(node, "name")), *type = json_string_value(json_object_get(node, "tagType"));
    size_t index;
    bool good = depth < MAX_DEPTH;
    bool folder = json_is_array(inner) || (type && (!strcmp(type, "Folder") || !strcmp(type, "Provider")));
    if (json_is_array(node)) {
        json_array_foreach(node, index, item) good = good && add_tags(list, item, path, depth + 1);
        return good;
    }
    if (!json_is_object(node) || !good || (type && !strcmp(type, "UdtType")))
        return good;
    if (folder) {
        char *below = name && *name ? mem_printf("%s%s%s", path, *path ? "/" : "", name) : mem_strdup(path);
        json_array_foreach(inner, index, item) good = good && add_tags(list, item, below, depth + 1);
        mem_free(below);
        return good;
    }
    list->rows++;
    if (!name || !*name) {
        list->nameless++;
        return true;
    }
    struct export_tag *tag = tag_export_add(list, 0);
    for (size_t i = 0; i < sizeof(properties) / sizeof(*properties); i++)
        set_from_json(list, tag, properties[i].field, json_object_get(node, properties[i].name));
    export_tag_set(tag, EXPORT_AREA, path);
    if (!tag->fields[EXPORT_NAME]) /* blanks only */
        export_tag_set(tag, EXPORT_NAME, "unnamed");
    return true;
}

bool tag_export_read_json(struct tag_export *list, const char *text, size_t length, char *why, size_t why_bytes)
{
    json_error_t error;
    json_t *root = json_loadb(text, length, 0, &error);
    list->format = "Ignition (JSON)";
    if (!root) {
        snprintf(why, why_bytes, "line %d: not JSON: %.120s", error.line, error.text);
        return false;
    }
    bool good = add_tags(list, root, "", 0);
    if (!good)
        snprintf(why, why_bytes, "folders deeper than %d", MAX_DEPTH);
    json_decref(root);
    return good;
}
