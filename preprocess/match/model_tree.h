/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The nodes of a glTF model with names, attributes (extras) and bounding boxes, and with vertices if these are stored
 * uncompressed. Call from any thread. */
#ifndef PREPROCESS_MATCH_MODEL_TREE_H
#define PREPROCESS_MATCH_MODEL_TREE_H
#include <jansson.h>

#include "plant/models/nodes.h"

struct tree_attribute {
    const char *name, *value;
};

struct tree_node {
    /* bounding box of the node and its subtree, in the scene's frame and the model's units; low > high: no geometry */
    double low[3], high[3];
    double from_node[16]; /* column-major transform from the node's frame to the scene's frame */
    struct tree_attribute *attributes;
    size_t attribute_count;
    int mesh; /* index of the node's mesh; -1: the node has none */
};

struct model_tree { /* zero-initialise */
    char *path;
    struct model_node *nodes; /* nodes of the model, depth first (plant/models/nodes.h) */
    struct tree_node *more;   /* by node: its attributes and its mesh */
    size_t count, capacity, more_capacity;
    json_t *json;
    char *bytes;        /* content of the whole file */
    const char *binary; /* the GLB file's binary chunk, inside `bytes`; NULL: none */
    size_t binary_bytes;
};

enum { TREE_WHY_BYTES = 200 };

/* Reads a .glb or .gltf file. Returns false with the reason in why. */
bool model_tree_read(struct model_tree *tree, const char *path, char why[TREE_WHY_BYTES]);
void model_tree_finish(struct model_tree *tree);
/* Finds the vertex of a node and its subtree that is nearest to a point. Returns false if no vertices can be read because they
 * are compressed or in another file. */
bool model_tree_nearest_vertex(const struct model_tree *tree, int node, const double point[3], double out[3]);

#endif
