/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reading and first-checking model files. */
#include "preprocess/model_source.h"

#include <errno.h>
#include <jansson.h>
#include <libgen.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <xxhash.h>

#include "base/mem.h"
#include "base/text.h"

#define JSON_MAX_LEVELS 64 /* of arrays and objects; glTF needs about ten, extras some more */

static bool wrong(char *why, const char *fmt, ...) __attribute__((format(printf, 2, 3)));
static bool wrong(char *why, const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(why, MODEL_WHY_BYTES, fmt, ap);
    va_end(ap);
    return false;
}

static uint32_t read_u32(const unsigned char *at)
{
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

/* The JSON of a GLB (its first chunk), or the whole of a .gltf. */
static bool find_json(const struct model_source *source, const char **json, size_t *length, char *why)
{
    const unsigned char *b = source->bytes;
    *json = (const char *)b;
    *length = source->size;
    if (!source->binary)
        return true;
    if (source->size < 20)
        return wrong(why, "truncated GLB: %zu bytes", source->size);
    if (read_u32(b + 4) != 2)
        return wrong(why, "GLB version %u, expected 2", read_u32(b + 4));
    if (read_u32(b + 8) > source->size)
        return wrong(why, "truncated GLB: %zu bytes of %u", source->size, read_u32(b + 8));
    if (memcmp(b + 16, "JSON", 4) != 0 || read_u32(b + 12) > source->size - 20)
        return wrong(why, "GLB: the first chunk is not JSON, or is cut off");
    *json = (const char *)b + 20;
    *length = read_u32(b + 12);
    return true;
}

static bool depth_good(const char *json, size_t length, char *why)
{
    int depth = 0;
    bool quoted = false;
    for (size_t i = 0; i < length; i++) {
        char c = json[i];
        if (quoted) {
            if (c == '\\')
                i++;
            else if (c == '"')
                quoted = false;
        } else if (c == '"') {
            quoted = true;
        } else if (c == '{' || c == '[') {
            if (++depth > JSON_MAX_LEVELS)
                return wrong(why, "JSON is nested deeper than %d levels", JSON_MAX_LEVELS);
        } else if (c == '}' || c == ']') {
            depth--;
        }
    }
    return true;
}

static bool views_good(const json_t *root, char *why)
{
    const json_t *buffers = json_object_get(root, "buffers"), *view;
    size_t i;
    json_array_foreach(json_object_get(root, "bufferViews"), i, view)
    {
        json_int_t buffer = json_integer_value(json_object_get(view, "buffer"));
        json_int_t offset = json_integer_value(json_object_get(view, "byteOffset")),
                   length = json_integer_value(json_object_get(view, "byteLength"));
        const json_t *target = buffer >= 0 ? json_array_get(buffers, (size_t)buffer) : NULL;
        json_int_t size = json_integer_value(json_object_get(target, "byteLength"));
        if (!target)
            return wrong(why, "bufferView %zu: there is no buffer %lld", i, (long long)buffer);
        if (offset < 0 || length < 1 || offset > size || length > size - offset)
            return wrong(why, "bufferView %zu: bytes %lld+%lld of a buffer of %lld", i, (long long)offset, (long long)length,
                         (long long)size);
    }
    return true;
}

static int hex_digit(char c)
{
    return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/* %20 and the like. Free with mem_free. */
static char *percent_decoded(const char *uri)
{
    char *out = mem_strdup(uri), *to = out;
    for (const char *at = uri; *at; at++) {
        int high = *at == '%' ? hex_digit(at[1]) : -1, low = high >= 0 ? hex_digit(at[2]) : -1;
        if (low >= 0) {
            *to++ = (char)(high * 16 + low);
            at += 2;
        } else {
            *to++ = *at;
        }
    }
    *to = 0;
    return out;
}

char *model_source_resolve(const char *folder, const char *name)
{
    struct stat st;
    char *joined = name[0] == '/' ? mem_strdup(name) : mem_printf("%s/%s", folder, name);
    char *real = realpath(joined, NULL);
    size_t length = strlen(folder);
    mem_free(joined);
    if (real && strncmp(real, folder, length) == 0 && (real[length] == '/' || strcmp(folder, "/") == 0) && stat(real, &st) == 0 &&
        S_ISREG(st.st_mode))
        return real;
    free(real);
    return NULL;
}

static bool hash_uri(const struct model_source *source, const char *what, size_t number, const json_t *uri, XXH3_state_t *hash, char *why)
{
    const char *text = json_string_value(uri);
    if (!text || strncmp(text, "data:", 5) == 0)
        return true;
    char *name = percent_decoded(text);
    char *path = name[0] != '/' && !strstr(name, "://") ? model_source_resolve(source->folder, name) : NULL;
    size_t size = 0;
    char *bytes = path ? text_read_file(path, MODEL_MAX_BYTES, &size) : NULL;
    bool good = bytes != NULL;
    if (good)
        XXH3_64bits_update(hash, bytes, size);
    else
        wrong(why, "%s %zu: '%.200s' is not a readable file inside the model's folder", what, number, name);
    mem_free(bytes);
    mem_free(name);
    free(path);
    return good;
}

static bool uris_good(struct model_source *source, const json_t *root, char *why)
{
    const char *const lists[] = { "buffers", "images" };
    const char *const names[] = { "buffer", "image" };
    XXH3_state_t *hash = XXH3_createState();
    bool good = hash != NULL;
    if (!good)
        return wrong(why, "out of memory");
    XXH3_64bits_reset(hash);
    XXH3_64bits_update(hash, source->bytes, source->size);
    for (int l = 0; l < 2 && good; l++) {
        size_t i;
        const json_t *item;
        json_array_foreach(json_object_get(root, lists[l]), i, item)
        {
            good = hash_uri(source, names[l], i, json_object_get(item, "uri"), hash, why);
            if (!good)
                break;
        }
    }
    source->hash = XXH3_64bits_digest(hash);
    XXH3_freeState(hash);
    return good;
}

static bool json_good(struct model_source *source, char *why)
{
    const char *text;
    size_t length;
    json_error_t error;
    if (!find_json(source, &text, &length, why) || !depth_good(text, length, why))
        return false;
    json_t *root = json_loadb(text, length, JSON_DISABLE_EOF_CHECK * (size_t)source->binary, &error);
    bool good = root != NULL;
    if (!good)
        wrong(why, "JSON: line %d, column %d: %s", error.line, error.column, error.text);
    else if (!json_is_object(root))
        good = wrong(why, "JSON: the top is not an object");
    good = good && views_good(root, why) && uris_good(source, root, why);
    json_decref(root);
    return good;
}

bool model_source_open(struct model_source *source, const char *path, char why[MODEL_WHY_BYTES])
{
    *source = (struct model_source){ .path = mem_strdup(path) };
    char *copy = mem_strdup(path), *folder = realpath(dirname(copy), NULL);
    mem_free(copy);
    if (folder)
        source->folder = folder;
    source->bytes = (unsigned char *)text_read_file(path, MODEL_MAX_BYTES, &source->size);
    if (!source->bytes || !source->folder) {
        wrong(why, "%s", strerror(errno));
        goto error;
    }
    source->binary = source->size >= 4 && memcmp(source->bytes, "glTF", 4) == 0;
    if (!json_good(source, why))
        goto error;
    return true;
error:
    model_source_finish(source);
    return false;
}

void model_source_finish(struct model_source *source)
{
    mem_free(source->path);
    free(source->folder);
    mem_free(source->bytes);
    *source = (struct model_source){ 0 };
}
