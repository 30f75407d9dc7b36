/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which node of a new export is which node of the old one: by GUID, else by the names from the top down, else by a name that occurs once,
 * else by the same box and as many nodes below the same parent (renamed). Pure. Thread: any. */
#ifndef PREPROCESS_IMPORT_NODE_PAIRS_H
#define PREPROCESS_IMPORT_NODE_PAIRS_H
#include "preprocess/import/model_outline.h"

struct node_pairs { /* by node of the outlines, depth first; -1: it has no other */
    int *to_new, *to_old;
};

/* Pairs the nodes of two outlines, both as model_outline_read() made them. The caller frees the result with node_pairs_finish(). */
void node_pairs_find(struct node_pairs *pairs, const struct model_outline *old_outline, const struct model_outline *new_outline);
void node_pairs_finish(struct node_pairs *pairs);

#endif
