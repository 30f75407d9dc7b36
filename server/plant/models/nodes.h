/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Matches the node patterns of a plant file, an asset's `nodes` and a tag's `Node` (PLANT.md), against the nodes of a model.
   Call from any thread. */
#ifndef PLANT_MODELS_NODES_H
#define PLANT_MODELS_NODES_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct model_node { /* node of a model. The array of nodes is in depth-first order: the sub-tree of a node is the range [node, end) */
    const char *name, *mesh; /* names of the node and of its mesh; "": it has none */
    int parent;              /* index of the node's parent; -1: the node is a root */
    uint32_t end;
    uint32_t number; /* node's index in the model file; for a node added for an instance: index of the instanced node */
};

#define NODES_SEPARATOR '\n' /* character between two node patterns in an asset's text of patterns (struct plant_asset, nodes) */

/* Sets taken[i] for each node that a pattern matches, and for the node's sub-tree. Patterns that begin with ! clear taken[i]
   instead. patterns NULL: all nodes. Returns false with the pattern in `why` if a pattern matches no node. */
bool nodes_take(const char *patterns, const struct model_node *nodes, size_t count, bool *taken, char *why, size_t why_bytes);

/* Finds the nodes that a pattern matches, without their sub-trees. `found` must hold `count` indices. Returns the number of matches; if
   it is 0, `why` has a message. */
size_t nodes_find(const char *pattern, const struct model_node *nodes, size_t count, uint32_t *found, char *why, size_t why_bytes);

#endif
