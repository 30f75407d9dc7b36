/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Merges all buffers of a glTF model into one, and converts image files to buffer views. */
#include "preprocess/import/gltf_pack.h"

#include <string.h>

#include "base/files/atomic_file.h"
#include "base/mem.h"
#include "preprocess/glb/glb_file.h"
#include "preprocess/model/model_json.h"
#include "preprocess/model/model_source.h"
#include "preprocess/model/model_uri.h"

struct pack {
    const struct model_source *source;
    json_t *root;
    struct model_bytes binary;
    struct text bytes;
    json_int_t *offsets; /* by buffer of the original model: its offset in the merged buffer, `bytes` */
    char *why;
};

static const char *uri_of(const json_t *object)
{
    return json_string_value(json_object_get(object, "uri"));
}

static bool names_files(const json_t *root)
{
    static const char *const lists[] = { "buffers", "images" };
    for (int l = 0; l < 2; l++) {
        const json_t *list = json_object_get(root, lists[l]);
        for (size_t i = 0; i < json_array_size(list); i++) {
            const char *uri = uri_of(json_array_get(list, i));
            if (uri && !model_uri_is_data(uri))
                return true;
        }
    }
    return false;
}

static json_int_t append(struct pack *pack, const void *bytes, size_t count)
{
    json_int_t at = (json_int_t)pack->bytes.length;
    text_add_bytes(&pack->bytes, bytes, count);
    text_add_bytes(&pack->bytes, "\0\0\0\0\0\0\0", (8 - count % 8) % 8);
    return at;
}

static bool take_buffers(struct pack *pack)
{
    const json_t *list = json_object_get(pack->root, "buffers");
    bool *standins = model_json_standins(pack->root), good = true;
    pack->offsets = mem_array(json_array_size(list) + 1, sizeof(*pack->offsets));
    for (size_t i = 0; good && i < json_array_size(list); i++) {
        char uri_why[MODEL_WHY_BYTES];
        const char *uri = uri_of(json_array_get(list, i));
        size_t size = pack->binary.size;
        if (!uri && standins[i])
            continue; /* omit an empty buffer that is only a fallback (EXT_meshopt_compression): the data is in compressed buffers */
        if (!uri && (i > 0 || !pack->binary.at)) {
            good = wrong(pack->why, "glTF buffer %zu has no data: export the model again, as a GLB file", i);
            break;
        }
        unsigned char *own = uri ? model_uri_read(pack->source->folder, uri, &size, uri_why) : NULL;
        if (uri && !own)
            good = wrong(pack->why, "buffer %zu: %s", i, uri_why);
        else
            pack->offsets[i] = append(pack, own ? own : pack->binary.at, size);
        mem_free(own);
    }
    mem_free(standins);
    return good;
}

/* Redirects a buffer view, or the compressed view in its meshopt extension, to the merged buffer by changing its buffer index
 * and offset. Returns false if the view is invalid. */
static bool move_view(struct pack *pack, json_t *view)
{
    const json_t *number = json_object_get(view, "buffer");
    json_int_t buffer = json_is_integer(number) ? json_integer_value(number) : -1;
    if (buffer < 0 || (size_t)buffer >= json_array_size(json_object_get(pack->root, "buffers")))
        return wrong(pack->why, "a glTF bufferView of the model refers to no buffer: export the model again");
    json_object_set_new(view, "byteOffset", json_integer(json_integer_value(json_object_get(view, "byteOffset")) + pack->offsets[buffer]));
    json_object_set_new(view, "buffer", json_integer(0));
    return true;
}

static bool move_views(struct pack *pack)
{
    json_t *views = json_object_get(pack->root, "bufferViews");
    for (size_t i = 0; i < json_array_size(views); i++) {
        json_t *view = json_array_get(views, i);
        json_t *compressed = json_object_get(json_object_get(view, "extensions"), "EXT_meshopt_compression");
        if (!move_view(pack, view) || (compressed && !move_view(pack, compressed)))
            return false;
    }
    return true;
}

static const char *image_type(const unsigned char *bytes, size_t size)
{
    if (size > 12 && !memcmp(bytes + 8, "WEBP", 4))
        return "image/webp";
    if (size > 12 && !memcmp(bytes, "\xabKTX", 4))
        return "image/ktx2";
    if (size > 4 && !memcmp(bytes, "\x89PNG", 4))
        return "image/png";
    return size > 3 && !memcmp(bytes, "\xff\xd8\xff", 3) ? "image/jpeg" : "application/octet-stream";
}

static bool take_images(struct pack *pack)
{
    json_t *list = json_object_get(pack->root, "images"), *views = json_object_get(pack->root, "bufferViews");
    for (size_t i = 0; i < json_array_size(list); i++) {
        char uri_why[MODEL_WHY_BYTES];
        json_t *image = json_array_get(list, i);
        const char *uri = uri_of(image);
        size_t size;
        if (!uri)
            continue;
        unsigned char *bytes = model_uri_read(pack->source->folder, uri, &size, uri_why);
        if (!bytes) /* omit an image that cannot be read: plantcast-prep will report the missing texture */
            continue;
        json_array_append_new(views, json_pack("{s:i,s:I,s:I}", "buffer", 0, "byteOffset", append(pack, bytes, size), "byteLength",
                                               (json_int_t)size));
        json_object_set_new(image, "bufferView", json_integer((json_int_t)json_array_size(views) - 1));
        json_object_set_new(image, "mimeType", json_string(image_type(bytes, size)));
        json_object_del(image, "uri");
        mem_free(bytes);
    }
    return true;
}

static bool write_packed(struct pack *pack, const char *glb)
{
    if (!take_buffers(pack) || !move_views(pack))
        return false;
    if (!json_object_get(pack->root, "bufferViews"))
        json_object_set_new(pack->root, "bufferViews", json_array());
    if (!take_images(pack))
        return false;
    if (json_array_size(json_object_get(pack->root, "bufferViews")) == 0) /* glTF forbids empty arrays */
        json_object_del(pack->root, "bufferViews");
    json_object_del(pack->root, "buffers");
    if (pack->bytes.length > 0)
        json_object_set_new(pack->root, "buffers", json_pack("[{s:I}]", "byteLength", (json_int_t)pack->bytes.length));
    int status = glb_file_put(pack->root, &pack->bytes, glb);
    return status == 0 || wrong(pack->why, "%s", strerror(-status));
}

bool gltf_pack(const char *path, const char *glb, char why[MODEL_WHY_BYTES])
{
    struct model_source source;
    struct pack pack = { .source = &source, .why = why };
    if (!model_source_open(&source, path, why))
        return false;
    pack.root = model_json_load((struct model_bytes){ source.bytes, source.size }, &pack.binary, why);
    bool good = pack.root != NULL, is_glb = source.size >= 4 && !memcmp(source.bytes, "glTF", 4);
    if (good && is_glb && !names_files(pack.root)) {
        int status = atomic_file_put(glb, source.bytes, source.size);
        good = status == 0 || wrong(why, "%s", strerror(-status));
    } else if (good) {
        good = write_packed(&pack, glb);
    }
    json_decref(pack.root);
    mem_free(pack.offsets);
    text_finish(&pack.bytes);
    model_source_finish(&source);
    return good;
}
