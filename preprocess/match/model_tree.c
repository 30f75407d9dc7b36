/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the nodes of a glTF file from its JSON, from the scene's roots down. Checks only the properties it uses; plantcast-prep
 * validates the rest. */
#include "preprocess/match/model_tree.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/text.h"
#include "plant/models/transform.h"

static const size_t max_bytes = (size_t)4 << 30;
enum { MAX_DEPTH = 400, MAX_NODES = 4000000 };

static uint32_t word_at(const char *bytes)
{
    uint32_t word;
    memcpy(&word, bytes, 4);
    return word;
}

static const char *text_of(json_t *object, const char *name)
{
    const char *text = json_string_value(json_object_get(object, name));
    return text ? text : "";
}

/* Returns an item of one of a glTF file's lists, or NULL if the index is missing or out of range. */
static json_t *item_of(json_t *root, const char *list, json_t *index)
{
    return json_is_integer(index) && json_integer_value(index) >= 0
               ? json_array_get(json_object_get(root, list), (size_t)json_integer_value(index))
               : NULL;
}

static void read_numbers(json_t *list, double *out, size_t count)
{
    for (size_t i = 0; i < count && json_array_size(list) == count; i++)
        out[i] = json_number_value(json_array_get(list, i));
}

static void read_transform(json_t *node, double out[16])
{
    double t[3] = { 0 }, q[4] = { 0, 0, 0, 1 }, s[3] = { 1, 1, 1 };
    memcpy(out, transform_identity, sizeof(transform_identity));
    if (json_object_get(node, "matrix")) {
        read_numbers(json_object_get(node, "matrix"), out, 16);
        return;
    }
    read_numbers(json_object_get(node, "translation"), t, 3);
    read_numbers(json_object_get(node, "rotation"), q, 4);
    read_numbers(json_object_get(node, "scale"), s, 3);
    transform_compose_quaternion(t, q, s, out);
}

static void include(struct tree_node *node, const double point[3])
{
    for (int axis = 0; axis < 3; axis++) {
        node->low[axis] = fmin(node->low[axis], point[axis]);
        node->high[axis] = fmax(node->high[axis], point[axis]);
    }
}

static void include_mesh(const struct model_tree *tree, struct tree_node *node)
{
    json_t *mesh = json_array_get(json_object_get(tree->json, "meshes"), (size_t)node->mesh), *primitive;
    size_t index;
    json_array_foreach(json_object_get(mesh, "primitives"), index, primitive)
    {
        json_t *accessor = item_of(tree->json, "accessors", json_object_get(json_object_get(primitive, "attributes"), "POSITION"));
        double ends[2][3] = { { NAN, NAN, NAN }, { NAN, NAN, NAN } };
        read_numbers(json_object_get(accessor, "min"), ends[0], 3);
        read_numbers(json_object_get(accessor, "max"), ends[1], 3);
        for (int corner = 0; corner < 8 && isfinite(ends[0][0]); corner++) {
            double out[3];
            transform_point(node->from_node, (double[3]){ ends[corner & 1][0], ends[corner >> 1 & 1][1], ends[corner >> 2][2] }, out);
            include(node, out);
        }
    }
}

static void add_attributes(struct tree_node *node, size_t *room, json_t *extras, int depth)
{
    const char *name;
    json_t *value;
    json_object_foreach(extras, name, value)
    {
        if (json_is_object(value) && depth < 4)
            add_attributes(node, room, value, depth + 1);
        if (!json_is_string(value))
            continue;
        mem_grow(&node->attributes, room, node->attribute_count + 1, sizeof(*node->attributes));
        node->attributes[node->attribute_count++] = (struct tree_attribute){ name, json_string_value(value) };
    }
}

static bool add_node(struct model_tree *tree, json_t *index, int parent, const double above[16], int depth)
{
    json_t *node = item_of(tree->json, "nodes", index), *child;
    size_t at = tree->count, child_index, room = 0;
    double own[16];
    if (!node || depth > MAX_DEPTH || tree->count >= MAX_NODES)
        return false;
    mem_grow(&tree->nodes, &tree->capacity, tree->count + 1, sizeof(*tree->nodes));
    mem_grow(&tree->more, &tree->more_capacity, tree->count + 1, sizeof(*tree->more));
    tree->count++;
    json_t *mesh = item_of(tree->json, "meshes", json_object_get(node, "mesh"));
    tree->nodes[at] = (struct model_node){
        .name = text_of(node, "name"), .mesh = text_of(mesh, "name"), .parent = parent, .number = (uint32_t)json_integer_value(index)
    };
    struct tree_node *more = &tree->more[at];
    *more = (struct tree_node){ .low = { INFINITY, INFINITY, INFINITY },
                                .high = { -INFINITY, -INFINITY, -INFINITY },
                                .mesh = mesh ? (int)json_integer_value(json_object_get(node, "mesh")) : -1 };
    read_transform(node, own);
    transform_multiply(above, own, more->from_node);
    add_attributes(more, &room, json_object_get(node, "extras"), 0);
    if (mesh)
        include_mesh(tree, more);
    double from_node[16];
    memcpy(from_node, more->from_node, sizeof(from_node));
    bool good = true;
    json_array_foreach(json_object_get(node, "children"), child_index, child) good =
        good && add_node(tree, child, (int)at, from_node, depth + 1);
    tree->nodes[at].end = (uint32_t)tree->count;
    more = &tree->more[at];
    if (parent >= 0 && more->low[0] <= more->high[0]) {
        include(&tree->more[parent], more->low);
        include(&tree->more[parent], more->high);
    }
    return good;
}

/* Finds the JSON text of a model file and, for a GLB file, the binary chunk. Returns false with the reason in why. */
static bool find_chunks(struct model_tree *tree, size_t length, const char **json, size_t *json_bytes)
{
    *json = tree->bytes;
    *json_bytes = length;
    if (length < 4 || memcmp(tree->bytes, "glTF", 4) != 0)
        return true;
    if (length < 20 || word_at(tree->bytes + 12) > length - 20)
        return false;
    *json = tree->bytes + 20;
    *json_bytes = word_at(tree->bytes + 12);
    size_t at = 20 + *json_bytes;
    if (length - at >= 8 && word_at(tree->bytes + at) <= length - at - 8) {
        tree->binary = tree->bytes + at + 8;
        tree->binary_bytes = word_at(tree->bytes + at);
    }
    return true;
}

bool model_tree_read(struct model_tree *tree, const char *path, char why[TREE_WHY_BYTES])
{
    const char *json;
    size_t length, json_bytes, index;
    json_error_t error;
    json_t *root;
    *tree = (struct model_tree){ .path = mem_strdup(path), .bytes = text_read_file(path, max_bytes, &length) };
    bool good = tree->bytes != NULL;
    if (!good) {
        snprintf(why, TREE_WHY_BYTES, "%s", strerror(errno));
    } else if (!find_chunks(tree, length, &json, &json_bytes) || !(tree->json = json_loadb(json, json_bytes, 0, &error))) {
        snprintf(why, TREE_WHY_BYTES, "not a glTF model");
        good = false;
    }
    json_t *scene = good ? item_of(tree->json, "scenes", json_object_get(tree->json, "scene")) : NULL;
    if (good && !scene)
        scene = json_array_get(json_object_get(tree->json, "scenes"), 0);
    json_array_foreach(json_object_get(scene, "nodes"), index, root) good = good && add_node(tree, root, -1, transform_identity, 0);
    if (good && tree->count == 0) {
        snprintf(why, TREE_WHY_BYTES, "has no nodes");
        good = false;
    } else if (!good && tree->json) {
        snprintf(why, TREE_WHY_BYTES, "the node tree has a missing node, a cycle, or more than %d levels or %d nodes", MAX_DEPTH,
                 MAX_NODES);
    }
    if (!good)
        model_tree_finish(tree);
    return good;
}

void model_tree_finish(struct model_tree *tree)
{
    for (size_t i = 0; i < tree->count; i++)
        mem_free(tree->more[i].attributes);
    mem_free(tree->nodes);
    mem_free(tree->more);
    mem_free(tree->bytes);
    mem_free(tree->path);
    json_decref(tree->json);
    *tree = (struct model_tree){ 0 };
}

/* --- vertices --------------------------------------------------------------------------------------------------------------- */

struct positions {
    const char *at;
    size_t count, stride;
};

/* Finds the vertex positions of a glTF primitive. Returns false unless they are an uncompressed list of floats in the file's own buffer. */
static bool find_positions(const struct model_tree *tree, json_t *primitive, struct positions *out)
{
    enum { FLOAT = 5126, BYTES = 12 };
    json_t *accessor = item_of(tree->json, "accessors", json_object_get(json_object_get(primitive, "attributes"), "POSITION"));
    json_t *view = item_of(tree->json, "bufferViews", json_object_get(accessor, "bufferView"));
    json_int_t buffer = json_integer_value(json_object_get(view, "buffer")), count = json_integer_value(json_object_get(accessor, "count")),
               from = json_integer_value(json_object_get(view, "byteOffset")),
               more = json_integer_value(json_object_get(accessor, "byteOffset")),
               stride = json_integer_value(json_object_get(view, "byteStride"));
    if (!tree->binary || !view || buffer != 0 || json_integer_value(json_object_get(accessor, "componentType")) != FLOAT ||
        json_object_get(accessor, "sparse") || json_object_get(view, "extensions"))
        return false;
    stride = stride ? stride : BYTES;
    json_int_t room = (json_int_t)tree->binary_bytes;
    if (count < 1 || from < 0 || more < 0 || stride < BYTES || from > room || more > room - from || room - from - more < BYTES ||
        (room - from - more - BYTES) / stride < count - 1)
        return false;
    *out = (struct positions){ tree->binary + from + more, (size_t)count, (size_t)stride };
    return true;
}

bool model_tree_nearest_vertex(const struct model_tree *tree, int node, const double point[3], double out[3])
{
    double best = INFINITY;
    for (size_t i = (size_t)node; i < tree->nodes[node].end; i++) {
        const struct tree_node *more = &tree->more[i];
        json_t *primitive, *mesh = more->mesh < 0 ? NULL : json_array_get(json_object_get(tree->json, "meshes"), (size_t)more->mesh);
        size_t index;
        json_array_foreach(json_object_get(mesh, "primitives"), index, primitive)
        {
            struct positions positions;
            json_t *mode = json_object_get(primitive, "mode");
            if ((mode && json_integer_value(mode) < 4) || !find_positions(tree, primitive, &positions))
                continue;
            for (size_t v = 0; v < positions.count; v++) {
                float stored[3];
                double at[3];
                memcpy(stored, positions.at + v * positions.stride, sizeof(stored));
                transform_point(more->from_node, (double[3]){ stored[0], stored[1], stored[2] }, at);
                double distance = hypot(hypot(at[0] - point[0], at[1] - point[1]), at[2] - point[2]);
                if (distance < best) {
                    best = distance;
                    memcpy(out, at, sizeof(at));
                }
            }
        }
    }
    return isfinite(best);
}
