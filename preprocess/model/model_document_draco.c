/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decodes KHR_draco_mesh_compression: each compressed primitive gets its own plain accessors. */

#include "base/mem.h"
#include "preprocess/model/draco_shim.h"
#include "preprocess/model/model_document_impl.h"
#include "plant/models/model_rules.h"

#define MODE_TRIANGLES 4

static size_t add_accessor(struct document_work *work, json_t *accessor, unsigned char *own, size_t size)
{
    json_t *accessors = json_object_get(work->root, "accessors");
    document_point_accessor(work, accessor, document_add_buffer(work, (struct document_bytes){ own, size, own }));
    json_object_del(accessor, "sparse");
    json_array_append_new(accessors, accessor);
    return json_array_size(accessors) - 1;
}

static bool take_attribute(struct document_work *work, const struct draco_mesh *mesh, json_t *primitive, const char *what, const char *name,
                           uint32_t id)
{
    json_t *attributes = json_object_get(primitive, "attributes"), *number = json_object_get(attributes, name);
    int component_type, width;
    if (!number)
        return wrong(work->why, "invalid glTF file: %s lacks the attribute %.40s, which its Draco-compressed data has", what, name);
    json_t *accessor = json_copy(json_array_get(json_object_get(work->root, "accessors"), (size_t)json_integer_value(number)));
    size_t element = document_element_bytes(accessor, &component_type, &width), size = element * draco_mesh_vertex_count(mesh);
    unsigned char *own = element ? mem_try_array(size + 1, 1) : NULL;
    if (!own || !draco_mesh_attribute(mesh, id, component_type, width, own)) {
        mem_free(own);
        json_decref(accessor);
        return wrong(work->why,
                     "invalid glTF file: %s: the Draco-compressed data lacks %.40s as attribute %u with %d components of type %d", what,
                     name, id, width, component_type);
    }
    json_object_set_new(accessor, "count", json_integer(draco_mesh_vertex_count(mesh)));
    json_object_set_new(attributes, name, json_integer((json_int_t)add_accessor(work, accessor, own, size)));
    return true;
}

static bool take_indices(struct document_work *work, const struct draco_mesh *mesh, json_t *primitive, const char *what)
{
    size_t count = 3 * (size_t)draco_mesh_triangle_count(mesh);
    uint32_t *own = mem_try_array(count + 1, sizeof(*own));
    if (!own)
        return wrong(work->why, "%s: cannot decode %zu indices of Draco-compressed data: out of memory", what, count);
    draco_mesh_indices(mesh, own);
    json_t *accessor = json_pack("{s:i,s:I,s:s}", "componentType", 5125, "count", (json_int_t)count, "type", "SCALAR");
    size_t number = add_accessor(work, accessor, (unsigned char *)own, count * sizeof(*own));
    json_object_set_new(primitive, "indices", json_integer((json_int_t)number));
    return true;
}

static bool expand(struct document_work *work, json_t *primitive, const json_t *extension, const char *what)
{
    const json_t *mode = json_object_get(primitive, "mode");
    const json_t *view =
        json_array_get(json_object_get(work->root, "bufferViews"), (size_t)json_integer_value(json_object_get(extension, "bufferView")));
    struct model_bytes from;
    char draco_why[MODEL_WHY_BYTES];
    const char *name;
    json_t *id;
    if (mode && json_integer_value(mode) != MODE_TRIANGLES)
        return wrong(work->why, "%s has Draco-compressed data of primitive mode %lld, but Plantcast supports only triangles (mode 4)", what,
                     json_integer_value(mode));
    if (!document_range(work, (size_t)json_integer_value(json_object_get(view, "buffer")),
                        (uint64_t)json_integer_value(json_object_get(view, "byteOffset")),
                        (uint64_t)json_integer_value(json_object_get(view, "byteLength")), what, &from))
        return false;
    struct draco_mesh *mesh = draco_mesh_decode(from.at, from.size, draco_why);
    if (!mesh)
        return wrong(work->why, "%s cannot be decompressed (KHR_draco_mesh_compression): %s", what, draco_why);
    bool good = take_indices(work, mesh, primitive, what);
    json_object_foreach(json_object_get(extension, "attributes"), name, id)
    {
        good = good && take_attribute(work, mesh, primitive, what, name, (uint32_t)json_integer_value(id));
    }
    draco_mesh_destroy(&mesh);
    return good;
}

bool document_expand_draco(struct document_work *work)
{
    const json_t *meshes = json_object_get(work->root, "meshes");
    for (size_t m = 0; m < json_array_size(meshes); m++) {
        json_t *primitives = json_object_get(json_array_get(meshes, m), "primitives");
        for (size_t p = 0; p < json_array_size(primitives); p++) {
            char what[160];
            json_t *primitive = json_array_get(primitives, p);
            const json_t *extension = json_object_get(json_object_get(primitive, "extensions"), "KHR_draco_mesh_compression");
            model_rules_name(work->root, "meshes", m, (int)p, what, sizeof(what));
            if (extension && !expand(work, primitive, extension, what))
                return false;
            json_object_del(primitive, "extensions");
        }
    }
    return true;
}
