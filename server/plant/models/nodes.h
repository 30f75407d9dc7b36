/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Matches the node patterns of a plant file, an asset's `nodes` and a tag's `Node` (PLANT.md), with the nodes of a model. Thread: any. */
#ifndef PLANT_MODELS_NODES_H
#define PLANT_MODELS_NODES_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct model_node { /* depth first: a node's sub-tree are the nodes [node, end) */
    const char *name, *mesh; /* "": none */
    int parent;              /* or -1 */
    uint32_t end;
    uint32_t number; /* in the file's list of nodes. Instances below a node have its number */
};

#define NODES_SEPARATOR '\n' /* between the patterns of an asset */

/* Sets taken[i] for each node that a pattern matches and for its sub-tree; patterns that begin with ! exclude theirs. patterns NULL: all
   nodes. Returns false if a pattern matches no node, and names it in why. */
bool nodes_take(const char *patterns, const struct model_node *nodes, size_t count, bool *taken, char *why, size_t why_bytes);

/* Finds the nodes that a pattern matches, without their sub-trees. found: room for count numbers. Returns how many there are; if there is
   none, why says so. */
size_t nodes_find(const char *pattern, const struct model_node *nodes, size_t count, uint32_t *found, char *why, size_t why_bytes);

#endif
