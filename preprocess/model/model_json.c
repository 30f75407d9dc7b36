/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finding and parsing the JSON of a model file. */
#include "preprocess/model/model_json.h"

#include <string.h>

#define MAX_LEVELS 64 /* of arrays and objects; glTF needs about ten, extras some more */

static uint32_t read_u32(const unsigned char *at)
{
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static bool glb_good(struct model_bytes file, struct model_bytes *json, struct model_bytes *binary, char *why)
{
    const unsigned char *b = file.at;
    if (file.size < 20)
        return wrong(why, "truncated GLB: %zu bytes", file.size);
    uint32_t size = read_u32(b + 8), json_bytes = read_u32(b + 12);
    if (read_u32(b + 4) != 2)
        return wrong(why, "GLB version %u, expected 2", read_u32(b + 4));
    if (size > file.size)
        return wrong(why, "truncated GLB: %zu bytes of %u", file.size, size);
    if (size < 20 || memcmp(b + 16, "JSON", 4) != 0 || json_bytes > size - 20)
        return wrong(why, "GLB: the first chunk is not JSON, or is cut off");
    *json = (struct model_bytes){ b + 20, json_bytes };
    const unsigned char *next = b + 20 + json_bytes;
    size_t left = size - 20 - json_bytes;
    if (left < 8)
        return true;
    uint32_t bytes = read_u32(next);
    if (bytes > left - 8)
        return wrong(why, "GLB: the second chunk has %u bytes, but only %zu are left", bytes, left - 8);
    if (memcmp(next + 4, "BIN\0", 4) == 0)
        *binary = (struct model_bytes){ next + 8, bytes };
    return true;
}

/* Parsers recurse. */
static bool depth_good(struct model_bytes json, char *why)
{
    int depth = 0;
    bool quoted = false;
    for (size_t i = 0; i < json.size; i++) {
        unsigned char c = json.at[i];
        if (quoted) {
            if (c == '\\')
                i++;
            else if (c == '"')
                quoted = false;
        } else if (c == '"') {
            quoted = true;
        } else if (c == '{' || c == '[') {
            if (++depth > MAX_LEVELS)
                return wrong(why, "JSON is nested deeper than %d levels", MAX_LEVELS);
        } else if (c == '}' || c == ']') {
            depth--;
        }
    }
    return true;
}

json_t *model_json_load(struct model_bytes file, struct model_bytes *binary, char why[MODEL_WHY_BYTES])
{
    struct model_bytes json = file;
    json_error_t error;
    *binary = (struct model_bytes){ 0 };
    bool is_glb = file.size >= 4 && memcmp(file.at, "glTF", 4) == 0;
    if (is_glb && !glb_good(file, &json, binary, why))
        return NULL;
    if (json.size >= 3 && memcmp(json.at, "\xEF\xBB\xBF", 3) == 0)
        json = (struct model_bytes){ json.at + 3, json.size - 3 };
    while (is_glb && json.size > 0 && json.at[json.size - 1] == 0) /* some writers pad with 0, not with blanks */
        json.size--;
    if (!depth_good(json, why))
        return NULL;
    json_t *root = json_loadb((const char *)json.at, json.size, 0, &error);
    if (!root) {
        wrong(why, "JSON: line %d, column %d: %s", error.line, error.column, error.text);
    } else if (!json_is_object(root)) {
        wrong(why, "JSON: the top is not an object");
        json_decref(root);
        root = NULL;
    }
    return root;
}

static const json_t *meshopt_of(const json_t *object)
{
    return json_object_get(json_object_get(object, "extensions"), "EXT_meshopt_compression");
}

bool model_json_is_standin(const json_t *root, size_t buffer)
{
    const json_t *views = json_object_get(root, "bufferViews"), *one = json_array_get(json_object_get(root, "buffers"), buffer);
    bool compressed = false, plain = false;
    if (json_is_true(json_object_get(meshopt_of(one), "fallback")))
        return true;
    for (size_t i = 0; i < json_array_size(views); i++) {
        const json_t *view = json_array_get(views, i), *number = json_object_get(view, "buffer");
        const json_t *meshopt = meshopt_of(view), *source = json_object_get(meshopt, "buffer");
        if (json_is_integer(number) && (size_t)json_integer_value(number) == buffer)
            *(meshopt ? &compressed : &plain) = true;
        if (json_is_integer(source) && (size_t)json_integer_value(source) == buffer)
            plain = true;
    }
    return compressed && !plain;
}
