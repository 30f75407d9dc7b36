/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds which node of a new export corresponds to which node of the old one. Compares, in this order: GUIDs; names from the
 * roots down; names that occur once; for renamed nodes below one parent, bounding boxes and numbers of descendants. No side
 * effects. Call from any thread. */
#ifndef PREPROCESS_IMPORT_NODE_PAIRS_H
#define PREPROCESS_IMPORT_NODE_PAIRS_H
#include "preprocess/import/model_outline.h"

struct node_pairs { /* by node of the outline (in depth-first order): index of its counterpart in the other model; -1: none */
    int *to_new, *to_old;
};

/* Pairs the nodes of two outlines read by model_outline_read(). The caller frees the result with node_pairs_finish(). */
void node_pairs_find(struct node_pairs *pairs, const struct model_outline *old_outline, const struct model_outline *new_outline);
void node_pairs_finish(struct node_pairs *pairs);

#endif
