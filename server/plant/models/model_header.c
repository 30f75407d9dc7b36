/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the JSON chunk of a GLB file, or a .gltf file, and lists the nodes of its scene. */
#include "plant/models/model_header.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/text.h"
#include "plant/models/model_rules.h"
#include "plant/models/node_rules.h"
#include "plant/models/transform.h"
#include "plant/parse/file_kind.h"

enum { MAX_JSON_BYTES = 512 << 20, GLB_HEAD_BYTES = 20 };

const struct model_box model_box_empty = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };

struct header_walk {
    struct model_header *header;
    const json_t *nodes, *meshes, *accessors;
    bool *seen;
    size_t capacity, box_capacity, origin_capacity;
    char why[MODEL_WHY_BYTES];
};

/* --- the file ----------------------------------------------------------------------------------------------------------------- */

static uint32_t u32_of(const unsigned char *at)
{
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

/* Reads only the JSON chunk, because the other chunks may have gigabytes. Returns NULL with the reason in `why` on failure. */
static char *read_json_chunk(FILE *file, size_t *count, char *why, size_t why_bytes)
{
    unsigned char head[GLB_HEAD_BYTES];
    if (fread(head, 1, sizeof(head), file) != sizeof(head) || u32_of(head + 4) != 2 || memcmp(head + 16, "JSON", 4) != 0) {
        snprintf(why, why_bytes, "is not a GLB file of version 2, or is truncated");
        return NULL;
    }
    *count = u32_of(head + 12);
    char *json = *count <= MAX_JSON_BYTES ? mem_try_array(*count + 1, 1) : NULL;
    if (json && fread(json, 1, *count, file) == *count)
        return json;
    snprintf(why, why_bytes, "is truncated: its JSON should have %zu bytes", *count);
    mem_free(json);
    return NULL;
}

static bool is_glb(FILE *file)
{
    char magic[4] = "";
    bool is = fread(magic, 1, 4, file) == 4 && !memcmp(magic, "glTF", 4);
    rewind(file);
    return is;
}

static json_t *read_json(const char *path, char *why, size_t why_bytes)
{
    static const char wanted[] = "expected glTF 2.0 (.glb or .gltf): export the model in this format, or convert it";
    const char *kind = file_kind_of(path);
    size_t count = 0;
    json_error_t error;
    FILE *file = fopen(path, "rb");
    if (!file) {
        snprintf(why, why_bytes, "%s", strerror(errno));
        return NULL;
    }
    bool glb = is_glb(file);
    if (!glb && kind)
        snprintf(why, why_bytes, "is %s; %s", kind, wanted);
    char *text = glb ? read_json_chunk(file, &count, why, why_bytes) : kind ? NULL : text_read_file(path, MAX_JSON_BYTES, &count);
    fclose(file);
    if (!text)
        return NULL;
    while (count > 0 && text[count - 1] == 0)
        count--;
    bool bom = count >= 3 && !memcmp(text, "\xEF\xBB\xBF", 3);
    json_t *root = json_loadb(text + 3 * bom, count - 3 * bom, 0, &error);
    if (!root && glb)
        snprintf(why, why_bytes, "has invalid JSON: line %d, column %d: %s", error.line, error.column, error.text);
    else if (!root)
        snprintf(why, why_bytes, "is not a glTF model; %s", wanted);
    mem_free(text);
    return root;
}

/* --- boxes ---------------------------------------------------------------------------------------------------------------------- */

void model_box_add(struct model_box *box, const struct model_box *other)
{
    for (int axis = 0; axis < 3; axis++) {
        box->low[axis] = fmin(box->low[axis], other->low[axis]);
        box->high[axis] = fmax(box->high[axis], other->high[axis]);
    }
}

/* Returns the divisor for the integers of a normalised glTF accessor: the integer that represents 1. */
static double divisor_of(const json_t *accessor)
{
    if (!json_is_true(json_object_get(accessor, "normalized")))
        return 1;
    switch (json_integer_value(json_object_get(accessor, "componentType"))) {
    case 5120: return 127;
    case 5121: return 255;
    case 5122: return 32767;
    case 5123: return 65535;
    default: return 1;
    }
}

/* Reads the bounding box (min and max) of a glTF accessor. Returns false if the accessor has none. */
static bool range_of(const json_t *accessor, struct model_box *out)
{
    const json_t *low = json_object_get(accessor, "min"), *high = json_object_get(accessor, "max");
    double divisor = divisor_of(accessor);
    for (size_t axis = 0; axis < 3; axis++) {
        const json_t *a = json_array_get(low, axis), *b = json_array_get(high, axis);
        if (!json_is_number(a) || !json_is_number(b))
            return false;
        out->low[axis] = json_number_value(a) / divisor;
        out->high[axis] = json_number_value(b) / divisor;
    }
    return true;
}

static void add_corners(struct model_box *box, const struct model_box *range, const double world[16])
{
    for (int corner = 0; corner < 8; corner++) {
        double p[3], q[3];
        for (int axis = 0; axis < 3; axis++)
            p[axis] = (corner >> axis & 1 ? range->high : range->low)[axis];
        transform_point(world, p, q);
        for (int axis = 0; axis < 3; axis++) {
            box->low[axis] = fmin(box->low[axis], q[axis]);
            box->high[axis] = fmax(box->high[axis], q[axis]);
        }
    }
}

static struct model_box box_of_mesh(const struct header_walk *walk, const json_t *mesh, const double world[16])
{
    struct model_box box = model_box_empty, range;
    const json_t *primitives = json_object_get(mesh, "primitives");
    for (size_t i = 0; i < json_array_size(primitives); i++) {
        const json_t *primitive = json_array_get(primitives, i), *mode = json_object_get(primitive, "mode");
        const json_t *place = json_object_get(json_object_get(primitive, "attributes"), "POSITION");
        if (mode && json_integer_value(mode) < 4) /* points and lines */
            continue;
        if (json_is_integer(place) && range_of(json_array_get(walk->accessors, (size_t)json_integer_value(place)), &range))
            add_corners(&box, &range, world);
        else
            walk->header->partial = true;
    }
    return box;
}

/* --- nodes ---------------------------------------------------------------------------------------------------------------------- */

/* Reads an array of numbers, the member `key` of a JSON object; leaves `out` unchanged if the member is missing. */
static bool numbers_of(const json_t *object, const char *key, double *out)
{
    const json_t *list = json_object_get(object, key);
    for (size_t i = 0; i < json_array_size(list); i++)
        out[i] = json_number_value(json_array_get(list, i));
    return list;
}

/* Reads the transform of a glTF node to its parent. Returns NULL, or the reason why the node is refused. */
static const char *local_of(const json_t *node, double out[16])
{
    double t[3] = { 0, 0, 0 }, q[4] = { 0, 0, 0, 1 }, s[3] = { 1, 1, 1 }, matrix[16];
    numbers_of(node, "translation", t);
    numbers_of(node, "rotation", q);
    numbers_of(node, "scale", s);
    return node_rules_local(t, q, s, numbers_of(node, "matrix", matrix) ? matrix : NULL, out);
}

static bool has_morph_weights(const json_t *node)
{
    const json_t *weights = json_object_get(node, "weights");
    for (size_t i = 0; i < json_array_size(weights); i++)
        if (json_number_value(json_array_get(weights, i)) != 0)
            return true;
    return false;
}

static const char *name_of(const json_t *object)
{
    const char *name = json_string_value(json_object_get(object, "name"));
    return name ? name : "";
}

/* Adds a node and its children. model_rules_check() has checked the types of all JSON members and their indices. */
static bool walk_node(struct header_walk *walk, size_t number, int parent, const double parent_world[16], int depth)
{
    struct model_header *header = walk->header;
    size_t self = header->count;
    const json_t *node = json_array_get(walk->nodes, number), *mesh_number = json_object_get(node, "mesh");
    const json_t *children = json_object_get(node, "children");
    if (walk->seen[number] || depth > NODE_MAX_DEPTH)
        return wrong(walk->why, "the nodes of the model are not a tree: node %zu is listed twice or nested too deep", number);
    if (header->count >= NODE_MAX_COUNT)
        return wrong(walk->why, "has more than %d nodes", NODE_MAX_COUNT);
    walk->seen[number] = true;
    const json_t *mesh = mesh_number ? json_array_get(walk->meshes, (size_t)json_integer_value(mesh_number)) : NULL;
    double local[16], world[16];
    const char *error = node_rules_shape(mesh, json_object_get(node, "skin"), has_morph_weights(node));
    error = error ? error : local_of(node, local);
    if (!error) {
        transform_multiply(parent_world, local, world);
        error = node_rules_world(world);
    }
    if (error)
        return wrong(walk->why, "is not valid: node %zu: %s", number, error);
    mem_grow(&header->nodes, &walk->capacity, header->count + 1, sizeof(*header->nodes));
    mem_grow(&header->boxes, &walk->box_capacity, header->count + 1, sizeof(*header->boxes));
    header->partial |= mesh && json_object_get(json_object_get(node, "extensions"), "EXT_mesh_gpu_instancing");
    mem_grow(&header->origins, &walk->origin_capacity, header->count + 1, sizeof(*header->origins));
    memcpy(header->origins[self], world + 12, sizeof(header->origins[self]));
    header->boxes[self] = mesh ? box_of_mesh(walk, mesh, world) : model_box_empty;
    header->nodes[header->count++] =
        (struct model_node){ .name = name_of(node), .mesh = name_of(mesh), .parent = parent, .number = (uint32_t)number };
    for (size_t i = 0; i < json_array_size(children); i++)
        if (!walk_node(walk, (size_t)json_integer_value(json_array_get(children, i)), (int)self, world, depth + 1))
            return false;
    header->nodes[self].end = (uint32_t)header->count;
    return true;
}

static bool walk_roots(struct header_walk *walk, const json_t *root)
{
    const json_t *scenes = json_object_get(root, "scenes"), *chosen = json_object_get(root, "scene");
    const json_t *roots = json_object_get(json_array_get(scenes, chosen ? (size_t)json_integer_value(chosen) : 0), "nodes");
    size_t count = json_array_size(walk->nodes);
    for (size_t i = 0; i < json_array_size(roots); i++)
        if (!walk_node(walk, (size_t)json_integer_value(json_array_get(roots, i)), -1, transform_identity, 0))
            return false;
    if (json_array_size(scenes) > 0)
        return true;
    bool *child = mem_array(count + 1, sizeof(*child)), good = true;
    for (size_t i = 0; i < count; i++) {
        const json_t *children = json_object_get(json_array_get(walk->nodes, i), "children");
        for (size_t c = 0; c < json_array_size(children); c++)
            child[json_integer_value(json_array_get(children, c))] = true;
    }
    for (size_t i = 0; i < count && good; i++)
        good = child[i] || walk_node(walk, i, -1, transform_identity, 0);
    mem_free(child);
    if (good && count > 0 && walk->header->count == 0)
        good = wrong(walk->why, "is not valid: every node is the child of another node");
    return good;
}

bool model_header_read(struct model_header *header, const char *path, char *why, size_t why_bytes)
{
    *header = (struct model_header){ 0 };
    json_t *root = read_json(path, why, why_bytes);
    if (!root)
        return false;
    header->json = root;
    const char *version = json_string_value(json_object_get(json_object_get(root, "asset"), "version"));
    struct header_walk walk = { .header = header };
    char invalid[MODEL_WHY_BYTES];
    bool good = version && version[0] == '2';
    if (!good)
        wrong(walk.why, "is not glTF 2.0: its asset.version is '%.20s'", version ? version : "");
    /* model_rules_check() must run before members of the document are looked up below, because it may delete members */
    else if (!model_rules_check(root, invalid))
        good = wrong(walk.why, "is not valid: %.*s", MODEL_WHY_BYTES - 20, invalid);
    walk.nodes = json_object_get(root, "nodes");
    walk.meshes = json_object_get(root, "meshes");
    walk.accessors = json_object_get(root, "accessors");
    walk.seen = mem_array(json_array_size(walk.nodes) + 1, sizeof(*walk.seen));
    good = good && walk_roots(&walk, root);
    mem_free(walk.seen);
    if (good)
        return true;
    snprintf(why, why_bytes, "%s", walk.why);
    model_header_finish(header);
    return false;
}

static uint64_t count_of(const json_t *accessors, const json_t *number)
{
    json_int_t count = json_is_integer(number)
                           ? json_integer_value(json_object_get(json_array_get(accessors, (size_t)json_integer_value(number)), "count"))
                           : 0;
    return count > 0 ? (uint64_t)count : 0;
}

uint64_t model_header_triangles(const struct model_header *header, size_t node)
{
    const json_t *root = header->json, *accessors = json_object_get(root, "accessors");
    const json_t *number = json_object_get(json_array_get(json_object_get(root, "nodes"), header->nodes[node].number), "mesh");
    const json_t *meshes = json_object_get(root, "meshes");
    const json_t *mesh = json_is_integer(number) ? json_array_get(meshes, (size_t)json_integer_value(number)) : NULL;
    const json_t *primitives = json_object_get(mesh, "primitives");
    uint64_t sum = 0;
    for (size_t i = 0; i < json_array_size(primitives); i++) {
        const json_t *primitive = json_array_get(primitives, i), *mode = json_object_get(primitive, "mode");
        const json_t *corners = json_object_get(primitive, "indices");
        uint64_t count = count_of(accessors, corners ? corners : json_object_get(json_object_get(primitive, "attributes"), "POSITION"));
        json_int_t kind = mode ? json_integer_value(mode) : 4;
        if (kind == 4)
            sum += count / 3;
        else if (kind > 4) /* triangle strips and fans */
            sum += count > 2 ? count - 2 : 0;
    }
    return sum;
}

void model_header_finish(struct model_header *header)
{
    json_decref(header->json);
    mem_free(header->nodes);
    mem_free(header->boxes);
    mem_free(header->origins);
    *header = (struct model_header){ 0 };
}
