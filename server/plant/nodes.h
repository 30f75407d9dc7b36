/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which nodes of a model a plant file means: patterns of an asset's `nodes`, and of a tag's `Node` (PLANT.md). Thread: any. */
#ifndef PLANT_NODES_H
#define PLANT_NODES_H
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

/* Sets taken[i] for each node that the patterns take, with the sub-trees; those that begin with ! leave theirs out. NULL: all. False: why
   names the pattern that no node matches. */
bool nodes_take(const char *patterns, const struct model_node *nodes, size_t count, bool *taken, char *why, size_t why_bytes);

/* The nodes that one pattern names, each alone, without its sub-tree. found: room for count numbers. 0: why says that there is none. */
size_t nodes_find(const char *pattern, const struct model_node *nodes, size_t count, uint32_t *found, char *why, size_t why_bytes);

#endif
