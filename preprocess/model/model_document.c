/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Normalises a glTF document. */
#include "preprocess/model/model_document_impl.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "preprocess/model/model_json.h"
#include "plant/models/model_rules.h"
#include "preprocess/model/model_uri.h"

/* maximum total bytes of accessors without a buffer view, which take no space in the file */
#define MAX_ZERO_BYTES ((uint64_t)64 << 20)

/* --- buffers ------------------------------------------------------------------------------------------------------------- */

static bool load_buffer(struct document_work *work, size_t number, const json_t *buffer, bool standin)
{
    struct document_bytes bytes = { 0 };
    char uri_why[MODEL_WHY_BYTES];
    const char *uri = json_string_value(json_object_get(buffer, "uri"));
    uint64_t length = document_number(buffer, "byteLength");
    if (uri) {
        bytes.at = bytes.own = model_uri_read(work->source->folder, uri, &bytes.size, uri_why);
        if (!bytes.at)
            return wrong(work->why, "buffer %zu: %s", number, uri_why);
    } else if (number == 0 && work->binary.at && !standin) {
        bytes = (struct document_bytes){ .at = work->binary.at, .size = work->binary.size };
    } else if (!standin) {
        return wrong(work->why, "incomplete glTF file: buffer %zu has no uri, and the file has no binary chunk: export the model again",
                     number);
    }
    size_t has = bytes.size;
    if (length < has)
        bytes.size = (size_t)length;
    document_add_buffer(work, bytes);
    if (length > has && bytes.at)
        return wrong(work->why, "incomplete glTF file: buffer %zu has %zu bytes instead of %" PRIu64, number, has, length);
    return true;
}

static bool load_buffers(struct document_work *work)
{
    const json_t *buffers = json_object_get(work->root, "buffers");
    bool *standins = model_json_standins(work->root), good = true;
    for (size_t i = 0; good && i < json_array_size(buffers); i++)
        good = load_buffer(work, i, json_array_get(buffers, i), standins[i]);
    mem_free(standins);
    return good;
}

static bool view_bytes(const struct document_work *work, size_t number, struct model_bytes *out)
{
    char what[40];
    const json_t *view = json_array_get(json_object_get(work->root, "bufferViews"), number);
    snprintf(what, sizeof(what), "bufferView %zu", number);
    return document_range(work, (size_t)document_number(view, "buffer"), document_number(view, "byteOffset"),
                          document_number(view, "byteLength"), what, out);
}

static bool views_good(const struct document_work *work)
{
    struct model_bytes bytes;
    for (size_t i = 0; i < json_array_size(json_object_get(work->root, "bufferViews")); i++)
        if (!view_bytes(work, i, &bytes))
            return false;
    return true;
}

/* --- accessors ----------------------------------------------------------------------------------------------------------- */

/* Gives an accessor without a buffer view a buffer of zeros, as glTF specifies; the accessor's sparse values may then replace
 * some of the zeros. */
static bool fill_with_zeros(struct document_work *work, const json_t *number, uint64_t *zeros)
{
    json_t *accessor = json_array_get(json_object_get(work->root, "accessors"), (size_t)json_integer_value(number));
    int component_type, width;
    if (!accessor || json_object_get(accessor, "bufferView"))
        return true;
    uint64_t count = document_number(accessor, "count"), element = document_element_bytes(accessor, &component_type, &width);
    if (count > MAX_ZERO_BYTES || (*zeros += count * element) > MAX_ZERO_BYTES)
        return wrong(work->why, "invalid glTF file: accessor %lld has %" PRIu64 " elements without data, more than Plantcast supports",
                     (long long)json_integer_value(number), count);
    unsigned char *own = mem_try_array(count * element + 1, 1);
    if (!own)
        return wrong(work->why, "cannot read accessor %lld of the glTF model: out of memory", (long long)json_integer_value(number));
    document_point_accessor(work, accessor, document_add_buffer(work, (struct document_bytes){ own, (size_t)(count * element), own }));
    work->document->total_bytes -= (size_t)(count * element);
    return true;
}

static bool fill_attributes(struct document_work *work, json_t *attributes, uint64_t *zeros)
{
    const char *key;
    json_t *number;
    json_object_foreach(attributes, key, number)
    {
        if (!fill_with_zeros(work, number, zeros))
            return false;
    }
    return true;
}

static bool fill_accessors(struct document_work *work)
{
    uint64_t zeros = 0;
    const json_t *meshes = json_object_get(work->root, "meshes"), *nodes = json_object_get(work->root, "nodes");
    for (size_t m = 0; m < json_array_size(meshes); m++) {
        const json_t *primitives = json_object_get(json_array_get(meshes, m), "primitives");
        for (size_t p = 0; p < json_array_size(primitives); p++) {
            const json_t *primitive = json_array_get(primitives, p), *indices = json_object_get(primitive, "indices");
            if (!fill_attributes(work, json_object_get(primitive, "attributes"), &zeros) ||
                (indices && !fill_with_zeros(work, indices, &zeros)))
                return false;
        }
    }
    for (size_t n = 0; n < json_array_size(nodes); n++) {
        const json_t *instancing = json_object_get(json_object_get(json_array_get(nodes, n), "extensions"), "EXT_mesh_gpu_instancing");
        if (!fill_attributes(work, json_object_get(instancing, "attributes"), &zeros))
            return false;
    }
    return true;
}

/* --- images -------------------------------------------------------------------------------------------------------------- */

static bool load_image(struct document_work *work, size_t number, const json_t *from, struct document_image *image)
{
    const json_t *view = json_object_get(from, "bufferView");
    const char *uri = json_string_value(json_object_get(from, "uri")), *name = json_string_value(json_object_get(from, "name"));
    char uri_why[MODEL_WHY_BYTES];
    image->name = mem_strdup(uri && !model_uri_is_data(uri) ? uri : name ? name : "");
    if (view) {
        struct model_bytes bytes;
        if (!view_bytes(work, (size_t)json_integer_value(view), &bytes))
            return false;
        image->bytes = (struct document_bytes){ .at = bytes.at, .size = bytes.size };
    } else if (uri) {
        image->bytes.at = image->bytes.own = model_uri_read(work->source->folder, uri, &image->bytes.size, uri_why);
        if (!image->bytes.at)
            image->missing = mem_strdup(uri_why);
    } else {
        return wrong(work->why, "invalid glTF file: image %zu has neither a uri nor a bufferView", number);
    }
    return true;
}

static bool load_images(struct document_work *work)
{
    const json_t *images = json_object_get(work->root, "images");
    struct model_document *d = work->document;
    d->images = mem_array(json_array_size(images) + 1, sizeof(*d->images));
    for (size_t i = 0; i < json_array_size(images); i++)
        if (!load_image(work, i, json_array_get(images, i), &d->images[d->image_count++]))
            return false;
    return true;
}

static const char specular[] = "KHR_materials_pbrSpecularGlossiness";

/* Records the ignored glTF extensions: required ones that affect only appearance, and unknown ones. */
static void take_left_out(struct document_work *work)
{
    const json_t *required = json_object_get(work->root, "extensionsRequired"), *used = json_object_get(work->root, "extensionsUsed");
    struct model_document *d = work->document;
    d->looks = mem_array(json_array_size(required) + json_array_size(used) + 1, sizeof(*d->looks));
    for (size_t i = 0; i < json_array_size(required); i++) {
        const char *name = json_string_value(json_array_get(required, i));
        if (name && model_rules_look(name))
            d->looks[d->look_count++] =
                mem_printf("Plantcast does not support the glTF extension %.100s, which the file requires: %s", name,
                           strcmp(name, specular) == 0 ? "diffuse colours are kept, specular colours are ignored"
                                                       : "the model is shown without it, because it affects only the look");
    }
    for (size_t i = 0; i < json_array_size(used); i++) {
        const char *name = json_string_value(json_array_get(used, i));
        if (name && !model_rules_known(name) && !model_rules_look(name))
            d->looks[d->look_count++] =
                mem_printf("the file uses the glTF extension %.100s, which Plantcast does not support and ignores", name);
    }
}

static void move_member(json_t *to, const char *as, json_t *from, const char *name)
{
    json_t *value = json_object_get(from, name);
    if (value && !json_is_null(value))
        json_object_set(to, as, value);
}

/* Converts the diffuse colour of specular-glossiness materials to a glTF base colour, unless the material has one. */
static void take_diffuse_colors(json_t *root)
{
    const json_t *materials = json_object_get(root, "materials");
    for (size_t i = 0; i < json_array_size(materials); i++) {
        json_t *material = json_array_get(materials, i), *pbr = json_object_get(material, "pbrMetallicRoughness");
        json_t *from = json_object_get(json_object_get(material, "extensions"), specular), *glossiness;
        if (!json_is_object(from) || json_object_get(pbr, "baseColorFactor") || json_object_get(pbr, "baseColorTexture"))
            continue;
        pbr = json_pack("{s:i}", "metallicFactor", 0);
        move_member(pbr, "baseColorFactor", from, "diffuseFactor");
        move_member(pbr, "baseColorTexture", from, "diffuseTexture");
        glossiness = json_object_get(from, "glossinessFactor");
        json_object_set_new(pbr, "roughnessFactor", json_real(json_is_number(glossiness) ? 1 - json_number_value(glossiness) : 0));
        json_object_set_new(material, "pbrMetallicRoughness", pbr);
    }
}

/* --- the whole ----------------------------------------------------------------------------------------------------------- */

static void strip(json_t *root)
{
    static const char *const unused[] = { "buffers",    "images",         "animations",         "skins", "cameras",
                                          "extensions", "extensionsUsed", "extensionsRequired", "extras" };
    static const char *const lists[] = { "nodes", "meshes", "materials", "accessors", "bufferViews", "scenes" };
    for (size_t i = 0; i < sizeof(unused) / sizeof(unused[0]); i++)
        json_object_del(root, unused[i]);
    for (size_t l = 0; l < sizeof(lists) / sizeof(lists[0]); l++) {
        const json_t *list = json_object_get(root, lists[l]);
        for (size_t i = 0; i < json_array_size(list); i++)
            json_object_del(json_array_get(list, i), "extras");
    }
}

static bool make_plain(struct document_work *work)
{
    take_diffuse_colors(work->root);
    if (!model_rules_check(work->root, work->why) || !load_buffers(work) || !document_expand_meshopt(work) || !views_good(work) ||
        !document_expand_draco(work) || !fill_accessors(work) || !load_images(work))
        return false;
    take_left_out(work);
    strip(work->root);
    work->document->json = json_dumps(work->root, JSON_COMPACT);
    if (!work->document->json)
        return wrong(work->why, "cannot read the JSON part of the glTF model: out of memory");
    work->document->json_bytes = strlen(work->document->json);
    return true;
}

bool model_document_open(struct model_document *document, const struct model_source *source, char why[MODEL_WHY_BYTES])
{
    struct document_work work = { .source = source, .document = document, .why = why };
    *document = (struct model_document){ 0 };
    work.root = model_json_load((struct model_bytes){ source->bytes, source->size }, &work.binary, why);
    bool good = work.root && make_plain(&work);
    json_decref(work.root);
    if (!good)
        model_document_finish(document);
    return good;
}

void model_document_finish(struct model_document *document)
{
    for (size_t i = 0; i < document->buffer_count; i++)
        mem_free(document->buffers[i].own);
    for (size_t i = 0; i < document->image_count; i++) {
        mem_free(document->images[i].name);
        mem_free(document->images[i].missing);
        mem_free(document->images[i].bytes.own);
    }
    for (size_t i = 0; i < document->look_count; i++)
        mem_free(document->looks[i]);
    mem_free(document->looks);
    mem_free(document->buffers);
    mem_free(document->images);
    free(document->json);
    *document = (struct model_document){ 0 };
}
