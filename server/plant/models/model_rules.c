/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks a glTF document by a table of rules, one for each property that is read later. */
#include "plant/models/model_rules.h"

#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum rule_kind { OBJECT, LIST, TEXT, FLAG, NUMBER, NUMBERS, SIZE, COUNT, INDEX, INDICES, ATTRIBUTES };
enum rule_need { MAY, MUST }; /* MUST: it is an error if a glTF object lacks the property; MAY: the property is optional */

struct model_rule {
    /* list: name of the glTF array that contains the object; path: name of the property; dots separate nested objects, which have rules of
       their own earlier in the table */
    const char *list, *path;
    enum rule_kind kind;
    enum rule_need need;
    /* kinds INDEX, INDICES, ATTRIBUTES: name of the glTF array that the property's value is an index into; NULL for ATTRIBUTES:
       any number is allowed */
    const char *target;
    size_t length;      /* kind NUMBERS: length of the array */
};

#define TEXTURE(path)                                                                                                                      \
    { "materials", path, OBJECT, MAY, NULL, 0 }, { "materials", path ".index", INDEX, MUST, "textures", 0 },                               \
        { "materials", path ".texCoord", COUNT, MAY, NULL, 0 }, { "materials", path ".extensions", OBJECT, MAY, NULL, 0 },                 \
        { "materials", path ".extensions.KHR_texture_transform", OBJECT, MAY, NULL, 0 },                                                   \
        { "materials", path ".extensions.KHR_texture_transform.offset", NUMBERS, MAY, NULL, 2 },                                           \
        { "materials", path ".extensions.KHR_texture_transform.scale", NUMBERS, MAY, NULL, 2 },                                            \
        { "materials", path ".extensions.KHR_texture_transform.rotation", NUMBER, MAY, NULL, 0 },                                          \
    {                                                                                                                                      \
        "materials", path ".extensions.KHR_texture_transform.texCoord", COUNT, MAY, NULL, 0                                                \
    }
#define MESHOPT "extensions.EXT_meshopt_compression"
#define DRACO "extensions.KHR_draco_mesh_compression"
#define INSTANCING "extensions.EXT_mesh_gpu_instancing"

/* clang-format off */
/* no rule for an accessor's bufferView: it is checked only when the accessor is read, because some files have unused accessors
   with invalid views */
static const struct model_rule rules[] = {
    { "buffers", "byteLength", SIZE, MUST, NULL, 0 }, { "buffers", "uri", TEXT, MAY, NULL, 0 },
    { "bufferViews", "buffer", INDEX, MUST, "buffers", 0 }, { "bufferViews", "byteOffset", SIZE, MAY, NULL, 0 },
    { "bufferViews", "byteLength", SIZE, MUST, NULL, 0 }, { "bufferViews", "byteStride", SIZE, MAY, NULL, 0 },
    { "bufferViews", "extensions", OBJECT, MAY, NULL, 0 }, { "bufferViews", MESHOPT, OBJECT, MAY, NULL, 0 },
    { "bufferViews", MESHOPT ".buffer", INDEX, MUST, "buffers", 0 }, { "bufferViews", MESHOPT ".byteOffset", SIZE, MAY, NULL, 0 },
    { "bufferViews", MESHOPT ".byteLength", SIZE, MUST, NULL, 0 }, { "bufferViews", MESHOPT ".byteStride", SIZE, MUST, NULL, 0 },
    { "bufferViews", MESHOPT ".count", SIZE, MUST, NULL, 0 }, { "bufferViews", MESHOPT ".mode", TEXT, MUST, NULL, 0 },
    { "bufferViews", MESHOPT ".filter", TEXT, MAY, NULL, 0 },
    { "accessors", "bufferView", COUNT, MAY, NULL, 0 }, { "accessors", "byteOffset", SIZE, MAY, NULL, 0 },
    { "accessors", "componentType", COUNT, MUST, NULL, 0 }, { "accessors", "count", SIZE, MUST, NULL, 0 },
    { "accessors", "type", TEXT, MUST, NULL, 0 }, { "accessors", "normalized", FLAG, MAY, NULL, 0 },
    { "accessors", "sparse", OBJECT, MAY, NULL, 0 }, { "accessors", "sparse.count", COUNT, MUST, NULL, 0 },
    { "accessors", "sparse.indices", OBJECT, MUST, NULL, 0 }, { "accessors", "sparse.indices.bufferView", COUNT, MUST, NULL, 0 },
    { "accessors", "sparse.indices.byteOffset", COUNT, MAY, NULL, 0 },
    { "accessors", "sparse.indices.componentType", COUNT, MUST, NULL, 0 },
    { "accessors", "sparse.values", OBJECT, MUST, NULL, 0 }, { "accessors", "sparse.values.bufferView", COUNT, MUST, NULL, 0 },
    { "accessors", "sparse.values.byteOffset", COUNT, MAY, NULL, 0 },
    { "meshes", "name", TEXT, MAY, NULL, 0 }, { "meshes", "primitives", LIST, MUST, NULL, 0 }, { "meshes", "weights", LIST, MAY, NULL, 0 },
    { "primitives", "attributes", ATTRIBUTES, MUST, "accessors", 0 }, { "primitives", "indices", INDEX, MAY, "accessors", 0 },
    { "primitives", "material", INDEX, MAY, "materials", 0 }, { "primitives", "mode", COUNT, MAY, NULL, 0 },
    { "primitives", "targets", LIST, MAY, NULL, 0 }, { "primitives", "extensions", OBJECT, MAY, NULL, 0 },
    { "primitives", DRACO, OBJECT, MAY, NULL, 0 }, { "primitives", DRACO ".bufferView", INDEX, MUST, "bufferViews", 0 },
    { "primitives", DRACO ".attributes", ATTRIBUTES, MUST, NULL, 0 },
    { "nodes", "name", TEXT, MAY, NULL, 0 }, { "nodes", "mesh", INDEX, MAY, "meshes", 0 }, { "nodes", "skin", INDEX, MAY, "skins", 0 },
    { "nodes", "children", INDICES, MAY, "nodes", 0 }, { "nodes", "matrix", NUMBERS, MAY, NULL, 16 },
    { "nodes", "translation", NUMBERS, MAY, NULL, 3 }, { "nodes", "rotation", NUMBERS, MAY, NULL, 4 },
    { "nodes", "scale", NUMBERS, MAY, NULL, 3 },
    { "nodes", "weights", LIST, MAY, NULL, 0 }, { "nodes", "extensions", OBJECT, MAY, NULL, 0 },
    { "nodes", INSTANCING, OBJECT, MAY, NULL, 0 },
    { "nodes", INSTANCING ".attributes", ATTRIBUTES, MUST, "accessors", 0 },
    { "scenes", "nodes", INDICES, MAY, "nodes", 0 },
    { "materials", "name", TEXT, MAY, NULL, 0 }, { "materials", "pbrMetallicRoughness", OBJECT, MAY, NULL, 0 },
    { "materials", "pbrMetallicRoughness.baseColorFactor", NUMBERS, MAY, NULL, 4 },
    { "materials", "pbrMetallicRoughness.metallicFactor", NUMBER, MAY, NULL, 0 },
    { "materials", "pbrMetallicRoughness.roughnessFactor", NUMBER, MAY, NULL, 0 },
    { "materials", "emissiveFactor", NUMBERS, MAY, NULL, 3 }, { "materials", "alphaMode", TEXT, MAY, NULL, 0 },
    { "materials", "alphaCutoff", NUMBER, MAY, NULL, 0 }, { "materials", "doubleSided", FLAG, MAY, NULL, 0 },
    { "materials", "extensions", OBJECT, MAY, NULL, 0 },
    TEXTURE("pbrMetallicRoughness.baseColorTexture"), TEXTURE("pbrMetallicRoughness.metallicRoughnessTexture"), TEXTURE("normalTexture"),
    TEXTURE("occlusionTexture"), TEXTURE("emissiveTexture"), { "materials", "normalTexture.scale", NUMBER, MAY, NULL, 0 },
    { "materials", "occlusionTexture.strength", NUMBER, MAY, NULL, 0 },
    { "textures", "source", INDEX, MAY, "images", 0 }, { "textures", "sampler", INDEX, MAY, "samplers", 0 },
    { "textures", "extensions", OBJECT, MAY, NULL, 0 }, { "textures", "extensions.EXT_texture_webp", OBJECT, MAY, NULL, 0 },
    { "textures", "extensions.EXT_texture_webp.source", INDEX, MUST, "images", 0 },
    { "samplers", "wrapS", COUNT, MAY, NULL, 0 }, { "samplers", "wrapT", COUNT, MAY, NULL, 0 },
    { "images", "uri", TEXT, MAY, NULL, 0 }, { "images", "bufferView", INDEX, MAY, "bufferViews", 0 },
    { "images", "name", TEXT, MAY, NULL, 0 },
};
/* clang-format on */

/* glTF extensions that this program implements; a file may require them */
static const char *const known_extensions[] = {
    "KHR_mesh_quantization", "EXT_meshopt_compression", "KHR_draco_mesh_compression", "KHR_texture_transform", "EXT_mesh_gpu_instancing",
    "EXT_texture_webp",
};

/* prefixes of names of glTF extensions that change neither shape nor position of a model; they are ignored */
static const char *const look_extensions[] = {
    "KHR_materials_", "EXT_materials_",     "ADOBE_materials_",        "KHR_texture_", "EXT_texture_",           "MSFT_texture_",
    "KHR_lights_",    "EXT_lights_",        "KHR_xmp",                 "KHR_audio",    "KHR_techniques_webgl",   "KHR_animation_pointer",
    "EXT_mesh_feat",  "EXT_instance_feat",  "EXT_structural_metadata", "MSFT_packing", "FB_ngon_encoding",       "EXT_feature_metadata",
    "AGI_",           "MAXAR_image_ortho",  "CESIUM_primitive_outline", "GODOT_single_root",
};

struct rule_check { /* the object being checked */
    json_t *root;
    const char *list; /* name of the glTF array that contains the object being checked; NULL: the object is the whole document */
    size_t number;
    int primitive; /* index of the primitive being checked in mesh `number`; -1: the object being checked is not a primitive */
    char *why;
};

static const struct {
    const char *list, *one;
} singular[] = { { "buffers", "buffer" },   { "bufferViews", "bufferView" }, { "accessors", "accessor" }, { "meshes", "mesh" },
                 { "nodes", "node" },       { "scenes", "scene" },           { "materials", "material" }, { "textures", "texture" },
                 { "samplers", "sampler" }, { "images", "image" },           { "skins", "skin" } };

static const char *one_of(const char *list)
{
    for (size_t i = 0; i < sizeof(singular) / sizeof(singular[0]); i++)
        if (strcmp(singular[i].list, list) == 0)
            return singular[i].one;
    return list;
}

void model_rules_name(const json_t *root, const char *list, size_t number, int primitive, char *out, size_t bytes)
{
    const char *name = json_string_value(json_object_get(json_array_get(json_object_get(root, list), number), "name"));
    int length = snprintf(out, bytes, name ? "%s %zu '%.80s'" : "%s %zu", one_of(list), number, name);
    if (primitive >= 0 && length >= 0 && (size_t)length < bytes)
        snprintf(out + length, bytes - (size_t)length, ", primitive %d", primitive);
}

static bool object_wrong(const struct rule_check *c, const char *fmt, ...) __attribute__((format(printf, 2, 3)));
static bool object_wrong(const struct rule_check *c, const char *fmt, ...)
{
    char what[160] = "file", text[MODEL_WHY_BYTES - 160];
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(text, sizeof(text), fmt, ap);
    va_end(ap);
    if (c->list)
        model_rules_name(c->root, c->list, c->number, c->primitive, what, sizeof(what));
    return wrong(c->why, "%s: %s", what, text);
}

/* Writes the whole number of a JSON value, written as 3 or 3.0, to *out. Returns false if the value is not a whole number. */
static bool whole(const json_t *value, json_int_t *out)
{
    double real = json_real_value(value);
    *out = json_integer_value(value);
    if (json_is_real(value) && real == floor(real) && fabs(real) < 9e15)
        *out = (json_int_t)real;
    else if (!json_is_integer(value))
        return false;
    return true;
}

static bool numbers_good(const json_t *value, size_t length)
{
    for (size_t i = 0; i < json_array_size(value); i++)
        if (!json_is_number(json_array_get(value, i)))
            return false;
    return json_is_array(value) && json_array_size(value) == length;
}

static bool index_good(const struct rule_check *c, const char *path, const json_t *value, const char *target)
{
    json_int_t index;
    if (!whole(value, &index))
        return object_wrong(c, "%s is not a whole number", path);
    if (index < 0 || (target && (size_t)index >= json_array_size(json_object_get(c->root, target))) || index > INT32_MAX)
        return object_wrong(c, "%s: there is no %s %lld", path, target ? one_of(target) : "such number:", (long long)index);
    return true;
}

static bool indices_good(const struct rule_check *c, const char *path, json_t *value, const char *target)
{
    if (!json_is_array(value))
        return object_wrong(c, "%s is not a list", path);
    for (size_t i = 0; i < json_array_size(value); i++) {
        json_int_t index;
        if (!index_good(c, path, json_array_get(value, i), target))
            return false;
        if (whole(json_array_get(value, i), &index) && json_is_real(json_array_get(value, i)))
            json_array_set_new(value, i, json_integer(index));
    }
    return true;
}

static bool attributes_good(const struct rule_check *c, const char *path, json_t *value, const char *target)
{
    const char *key;
    json_t *one;
    void *next;
    if (!json_is_object(value))
        return object_wrong(c, "%s is not an object", path);
    json_object_foreach_safe(value, next, key, one)
    {
        json_int_t index;
        if (!index_good(c, key, one, target))
            return false;
        if (whole(one, &index) && json_is_real(one))
            json_object_set_new(value, key, json_integer(index));
    }
    return true;
}

static bool whole_good(const struct rule_check *c, const struct model_rule *rule, json_t *parent, const char *key, const json_t *value)
{
    json_int_t number;
    json_int_t most = rule->kind == COUNT ? INT32_MAX : INT64_MAX;
    if (rule->kind == INDEX && !index_good(c, rule->path, value, rule->target))
        return false;
    if (!whole(value, &number) || number < 0 || number > most)
        return object_wrong(c, "%s is not a whole number from 0 to %lld", rule->path, (long long)most);
    if (json_is_real(value))
        json_object_set_new(parent, key, json_integer(number));
    return true;
}

static bool value_good(const struct rule_check *c, const struct model_rule *rule, json_t *parent, const char *key, json_t *value)
{
    const char *expected = NULL;
    switch (rule->kind) {
    case OBJECT: expected = json_is_object(value) ? NULL : "an object"; break;
    case LIST: expected = json_is_array(value) ? NULL : "a list"; break;
    case TEXT: expected = json_is_string(value) ? NULL : "text"; break;
    case FLAG: expected = json_is_boolean(value) ? NULL : "true or false"; break;
    case NUMBER: expected = json_is_number(value) ? NULL : "a number"; break;
    case NUMBERS:
        if (!numbers_good(value, rule->length))
            return object_wrong(c, "%s is not %zu numbers", rule->path, rule->length);
        break;
    case SIZE:
    case COUNT:
    case INDEX: return whole_good(c, rule, parent, key, value);
    case INDICES: return indices_good(c, rule->path, value, rule->target);
    case ATTRIBUTES: return attributes_good(c, rule->path, value, rule->target);
    }
    return !expected || object_wrong(c, "%s is not %s", rule->path, expected);
}

static bool rule_good(const struct rule_check *c, const struct model_rule *rule, json_t *item)
{
    char key[64];
    json_t *parent = item;
    const char *at = rule->path;
    for (const char *dot; (dot = strchr(at, '.')); at = dot + 1) {
        snprintf(key, sizeof(key), "%.*s", (int)(dot - at), at);
        parent = json_object_get(parent, key);
        if (!parent)
            return true;
    }
    json_t *value = json_object_get(parent, at);
    if (json_is_null(value)) {
        json_object_del(parent, at);
        value = NULL;
    }
    if (!value)
        return rule->need == MAY || object_wrong(c, "has no %s", rule->path);
    return value_good(c, rule, parent, at, value);
}

static bool item_good(const struct rule_check *c, const char *list, json_t *item)
{
    if (!json_is_object(item))
        return object_wrong(c, "is not an object");
    for (size_t i = 0; i < sizeof(rules) / sizeof(rules[0]); i++)
        if (strcmp(rules[i].list, list) == 0 && !rule_good(c, &rules[i], item))
            return false;
    return true;
}

static bool primitives_good(const struct rule_check *mesh, const json_t *primitives)
{
    struct rule_check c = *mesh;
    for (size_t i = 0; i < json_array_size(primitives); i++) {
        c.primitive = (int)i;
        if (!item_good(&c, "primitives", json_array_get(primitives, i)))
            return false;
    }
    return true;
}

static bool list_good(json_t *root, const char *list, char *why)
{
    json_t *items = json_object_get(root, list);
    if (json_is_null(items))
        json_object_del(root, list);
    else if (items && !json_is_array(items))
        return wrong(why, "%s is not a list", list);
    for (size_t i = 0; i < json_array_size(items); i++) {
        struct rule_check c = { root, list, i, -1, why };
        json_t *item = json_array_get(items, i);
        if (!item_good(&c, list, item))
            return false;
        if (strcmp(list, "meshes") == 0 && !primitives_good(&c, json_object_get(item, "primitives")))
            return false;
    }
    return true;
}

bool model_rules_known(const char *name)
{
    bool known = false;
    for (size_t i = 0; !known && i < sizeof(known_extensions) / sizeof(known_extensions[0]); i++)
        known = strcmp(name, known_extensions[i]) == 0;
    return known;
}

bool model_rules_look(const char *name)
{
    bool look = false;
    for (size_t i = 0; !look && i < sizeof(look_extensions) / sizeof(look_extensions[0]); i++)
        look = strncmp(name, look_extensions[i], strlen(look_extensions[i])) == 0;
    return look && !model_rules_known(name);
}

static bool head_good(json_t *root, char *why)
{
    const json_t *asset = json_object_get(root, "asset"), *required = json_object_get(root, "extensionsRequired");
    const char *version = json_string_value(json_object_get(asset, "version")),
               *least = json_string_value(json_object_get(asset, "minVersion"));
    if (!version || strncmp(version, "2.", 2) != 0 || (least && strcmp(least, "2.0") != 0))
        return wrong(why, "glTF version '%.20s', expected 2.0", !version ? "" : least ? least : version);
    if (required && !json_is_array(required))
        return wrong(why, "extensionsRequired is not a list");
    for (size_t i = 0; i < json_array_size(required); i++) {
        const char *name = json_string_value(json_array_get(required, i));
        if (!name || (!model_rules_known(name) && !model_rules_look(name)))
            return wrong(why, "the model requires the glTF extension %.100s, which Plantcast does not support",
                         name ? name : "without a name");
    }
    static const struct model_rule scene = { "", "scene", INDEX, MAY, "scenes", 0 };
    return rule_good(&(struct rule_check){ root, NULL, 0, -1, why }, &scene, root);
}

bool model_rules_check(json_t *root, char why[MODEL_WHY_BYTES])
{
    if (!head_good(root, why))
        return false;
    for (size_t i = 0; i < sizeof(singular) / sizeof(singular[0]); i++)
        if (!list_good(root, singular[i].list, why))
            return false;
    return true;
}
