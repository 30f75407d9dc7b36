/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds and parses the JSON text of a glTF or GLB file. */
#include "preprocess/model/model_json.h"

#include <string.h>

#include "base/mem.h"

#define MAX_LEVELS 64 /* maximum nesting depth of JSON arrays and objects; glTF needs about ten levels, free-form `extras` a few more */

static uint32_t read_u32(const unsigned char *at)
{
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static bool glb_good(struct model_bytes file, struct model_bytes *json, struct model_bytes *binary, char *why)
{
    const unsigned char *b = file.at;
    if (file.size < 20)
        return wrong(why, "the GLB file is truncated: it has only %zu bytes", file.size);
    uint32_t size = read_u32(b + 8), json_bytes = read_u32(b + 12);
    if (read_u32(b + 4) != 2)
        return wrong(why, "the GLB file has version %u; Plantcast supports only version 2", read_u32(b + 4));
    if (size > file.size)
        return wrong(why, "the GLB file is truncated: it has %zu of %u bytes", file.size, size);
    if (size < 20 || memcmp(b + 16, "JSON", 4) != 0 || json_bytes > size - 20)
        return wrong(why, "the GLB file is damaged: its first chunk is not JSON, or is truncated");
    *json = (struct model_bytes){ b + 20, json_bytes };
    size_t at = 20 + (size_t)json_bytes;
    while (!binary->at && size - at >= 8) {
        uint32_t bytes = read_u32(b + at);
        if (bytes > size - at - 8)
            return wrong(why, "the GLB file is damaged: the chunk at byte %zu should have %u bytes, but only %zu follow", at, bytes,
                         size - at - 8);
        if (memcmp(b + at + 4, "BIN\0", 4) == 0)
            *binary = (struct model_bytes){ b + at + 8, bytes };
        at += 8 + (size_t)bytes;
    }
    return true;
}

/* Returns whether the nesting depth of the JSON text is within MAX_LEVELS; otherwise the recursive JSON parser could overflow the stack. */
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
                return wrong(why, "the JSON part of the glTF model is nested deeper than %d levels", MAX_LEVELS);
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
    /* accept zero bytes after the JSON: some writers pad with them instead of blanks */
    while (is_glb && json.size > 0 && json.at[json.size - 1] == 0)
        json.size--;
    if (!depth_good(json, why))
        return NULL;
    json_t *root = json_loadb((const char *)json.at, json.size, 0, &error);
    if (!root) {
        wrong(why, "the JSON part of the glTF model is invalid: line %d, column %d: %s", error.line, error.column, error.text);
    } else if (!json_is_object(root)) {
        wrong(why, "invalid glTF file: its JSON part is not an object");
        json_decref(root);
        root = NULL;
    }
    return root;
}

static const json_t *meshopt_of(const json_t *object)
{
    return json_object_get(json_object_get(object, "extensions"), "EXT_meshopt_compression");
}

/* Returns the object's member "buffer", an index below `count`, or `count` if it is missing or invalid. */
static size_t number_in(const json_t *object, size_t count)
{
    const json_t *number = json_object_get(object, "buffer");
    json_int_t buffer = json_is_integer(number) ? json_integer_value(number) : -1;
    return buffer >= 0 && (size_t)buffer < count ? (size_t)buffer : count;
}

bool *model_json_standins(const json_t *root)
{
    const json_t *buffers = json_object_get(root, "buffers"), *views = json_object_get(root, "bufferViews");
    size_t count = json_array_size(buffers);
    bool *compressed = mem_array(count + 1, sizeof(*compressed)), *plain = mem_array(count + 1, sizeof(*plain));
    for (size_t i = 0; i < json_array_size(views); i++) {
        const json_t *view = json_array_get(views, i), *meshopt = meshopt_of(view);
        size_t buffer = number_in(view, count), source = number_in(meshopt, count);
        (meshopt ? compressed : plain)[buffer] = true;
        plain[source] = true;
    }
    for (size_t i = 0; i < count; i++)
        compressed[i] = (compressed[i] && !plain[i]) || json_is_true(json_object_get(meshopt_of(json_array_get(buffers, i)), "fallback"));
    mem_free(plain);
    return compressed;
}
