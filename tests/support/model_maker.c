/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes glTF models. */
#include "tests/support/model_maker.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "tests/support/glb.h"
#include "tests/support/temp.h"

void maker_init(struct model_maker *maker)
{
    *maker = (struct model_maker){ .root = json_pack("{s:{s:s}}", "asset", "version", "2.0") };
}

void maker_finish(struct model_maker *maker)
{
    json_decref(maker->root);
    text_finish(&maker->bin);
}

int maker_add(struct model_maker *maker, const char *list, json_t *object)
{
    json_t *items = json_object_get(maker->root, list);
    if (!items) {
        items = json_array();
        json_object_set_new(maker->root, list, items);
    }
    json_array_append_new(items, object);
    return (int)json_array_size(items) - 1;
}

json_t *maker_get(struct model_maker *maker, const char *list, int number)
{
    return json_array_get(json_object_get(maker->root, list), (size_t)number);
}

int maker_view(struct model_maker *maker, const void *bytes, size_t count, int stride)
{
    while (maker->bin.length % 4 != 0)
        text_add_bytes(&maker->bin, "", 1);
    json_t *view = json_pack("{s:i,s:I,s:I}", "buffer", 0, "byteOffset", (json_int_t)maker->bin.length, "byteLength", (json_int_t)count);
    if (stride)
        json_object_set_new(view, "byteStride", json_integer(stride));
    text_add_bytes(&maker->bin, bytes, count);
    return maker_add(maker, "bufferViews", view);
}

int maker_accessor(struct model_maker *maker, int view, int component_type, size_t count, const char *type)
{
    json_t *accessor = json_pack("{s:i,s:I,s:s}", "componentType", component_type, "count", (json_int_t)count, "type", type);
    if (view >= 0)
        json_object_set_new(accessor, "bufferView", json_integer(view));
    return maker_add(maker, "accessors", accessor);
}

int maker_numbers(struct model_maker *maker, const void *bytes, size_t size, int component_type, size_t count, const char *type)
{
    return maker_accessor(maker, maker_view(maker, bytes, size, 0), component_type, count, type);
}

int maker_mesh(struct model_maker *maker, json_t *primitive)
{
    return maker_add(maker, "meshes", json_pack("{s:s,s:[o]}", "name", "m", "primitives", primitive));
}

int maker_node(struct model_maker *maker, const char *name, int mesh, json_t *more)
{
    json_t *node = json_pack("{s:s}", "name", name);
    if (mesh >= 0)
        json_object_set_new(node, "mesh", json_integer(mesh));
    json_object_update(node, more);
    json_decref(more);
    return maker_add(maker, "nodes", node);
}

void maker_require(struct model_maker *maker, const char *extension)
{
    maker_add(maker, "extensionsRequired", json_string(extension));
    maker_add(maker, "extensionsUsed", json_string(extension));
}

/* Returns the model as JSON text, with `uri` as the location of its buffer. It has no scene: the loader then takes the nodes
   without a parent as root nodes. */
static char *json_of(struct model_maker *maker, const char *uri)
{
    json_t *buffers = json_object_get(maker->root, "buffers"), *first = json_array_get(buffers, 0);
    if (!first && maker->bin.length) {
        first = json_object();
        maker_add(maker, "buffers", first);
    }
    if (first && !json_object_get(first, "byteLength"))
        json_object_set_new(first, "byteLength", json_integer((json_int_t)maker->bin.length));
    if (uri)
        json_object_set_new(first, "uri", json_string(uri));
    return json_dumps(maker->root, JSON_COMPACT);
}

char *maker_glb(struct model_maker *maker, size_t *size)
{
    char *json = json_of(maker, NULL), *glb = glb_build(json, maker->bin.at, maker->bin.length, size);
    free(json);
    return glb;
}

char *maker_gltf(struct model_maker *maker, size_t *size)
{
    char *uri = maker_data_uri("application/octet-stream", maker->bin.at, maker->bin.length);
    char *json = json_of(maker, uri), *out = mem_strdup(json);
    *size = strlen(out);
    free(json);
    mem_free(uri);
    return out;
}

char *maker_data_uri(const char *kind, const void *bytes, size_t count)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const unsigned char *b = bytes;
    struct text text = { 0 };
    text_add(&text, "data:%s;base64,", kind);
    for (size_t i = 0; i < count; i += 3) {
        unsigned bits = (unsigned)b[i] << 16 | (i + 1 < count ? (unsigned)b[i + 1] << 8 : 0) | (i + 2 < count ? b[i + 2] : 0u);
        text_add(&text, "%c%c%c%c", digits[bits >> 18], digits[bits >> 12 & 63], i + 1 < count ? digits[bits >> 6 & 63] : '=',
                 i + 2 < count ? digits[bits & 63] : '=');
    }
    return text.at;
}

int maker_triangles(struct model_maker *maker, const float (*positions)[3], size_t vertex_count, const uint32_t *indices,
                    size_t index_count)
{
    int at = maker_numbers(maker, positions, vertex_count * sizeof(*positions), FLOAT, vertex_count, "VEC3");
    int list = maker_numbers(maker, indices, index_count * sizeof(*indices), UINT, index_count, "SCALAR");
    return maker_mesh(maker, json_pack("{s:{s:i},s:i}", "attributes", "POSITION", at, "indices", list));
}

void maker_cad(struct model_maker *maker, const char *node, const struct cad *cad)
{
    int mesh = maker_triangles(maker, (const float(*)[3])cad->positions, cad->vertex_count, cad->triangles, 3 * cad->triangle_count);
    maker_node(maker, node, mesh, NULL);
}

void maker_write(struct model_maker *maker, const char *folder, const char *name)
{
    size_t size;
    char *glb = maker_glb(maker, &size);
    temp_write(folder, name, glb, size);
    mem_free(glb);
    maker_finish(maker);
}

void maker_write_cad(const char *folder, const char *name, const char *node, const struct cad *cad)
{
    struct model_maker maker;
    maker_init(&maker);
    maker_cad(&maker, node, cad);
    maker_write(&maker, folder, name);
}
