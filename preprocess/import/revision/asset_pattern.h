/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Patterns of nodes (nodes.h) that were written for the old model, for the new one: a renamed node's becomes its new name, a number
 * the new number. Thread: one. */
#ifndef PREPROCESS_IMPORT_ASSET_PATTERN_H
#define PREPROCESS_IMPORT_ASSET_PATTERN_H
#include "plant/models/model_header.h"
#include "preprocess/import/revision/node_pairs.h"

struct asset_patterns {
    const struct model_header *before, *after; /* must outlive it */
    const struct node_pairs *pairs;
    uint32_t *old_names, *new_names; /* nodes, sorted by name */
    uint32_t *found;                 /* room for all of either */
};

void asset_patterns_init(struct asset_patterns *patterns, const struct model_header *before, const struct model_header *after,
                         const struct node_pairs *pairs);
void asset_patterns_finish(struct asset_patterns *patterns);

enum asset_pattern_change { ASSET_PATTERN_SAME, ASSET_PATTERN_OTHER, ASSET_PATTERN_GONE };
/* Says what becomes of a pattern, without "!" before it. `before` marks the old nodes that are preferred where it names several; NULL:
 * none. Of ASSET_PATTERN_OTHER *out is the new pattern (mem_free). */
enum asset_pattern_change asset_patterns_follow(struct asset_patterns *patterns, const char *pattern, const bool *before, char **out);

/* Brings an asset's patterns, one a line, up to date. Returns them in the same form (mem_free), or NULL if none is left that takes
 * anything. Where any has changed, *nodes (mem_free, each and all) has for each of them the new one, or NULL where it goes. */
char *asset_patterns_update(struct asset_patterns *patterns, const char *lines, char ***nodes, size_t *node_count);

#endif
