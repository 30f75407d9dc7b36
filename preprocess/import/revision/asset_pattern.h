/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rewrites node patterns (nodes.h) of the old model so that they match the same nodes of the new model: a renamed node's
 * pattern becomes its new name, and "#number" the new number. Call from one thread only. */
#ifndef PREPROCESS_IMPORT_ASSET_PATTERN_H
#define PREPROCESS_IMPORT_ASSET_PATTERN_H
#include "plant/models/model_header.h"
#include "preprocess/import/revision/node_pairs.h"

struct asset_patterns {
    const struct model_header *before, *after; /* trees of nodes of the old and the new model; must outlive this struct */
    const struct node_pairs *pairs;
    uint32_t *old_names, *new_names; /* nodes of the old and of the new model, sorted by name */
    uint32_t *found;                 /* indices of the nodes found by the last search; has room for all nodes of the larger model */
    bool *gained;                    /* by node of the new model: asset_patterns_add_gained() has marked it */
};

void asset_patterns_init(struct asset_patterns *patterns, const struct model_header *before, const struct model_header *after,
                         const struct node_pairs *pairs);
void asset_patterns_finish(struct asset_patterns *patterns);

/* Marks the nodes that an asset's paths and wildcards select in the new model, but not in the old one. Call for all assets of the
 * model before asset_patterns_update(), which lets such a node leave its former asset. lines: one pattern per line. */
void asset_patterns_add_gained(struct asset_patterns *patterns, const char *lines);

enum asset_pattern_change { ASSET_PATTERN_SAME, ASSET_PATTERN_OTHER, ASSET_PATTERN_GONE };
/* Determines how a pattern (without a leading "!") must change: not at all, to another text, or not possible because the new
 * model has no such node. before: nodes of the old model that are preferred if the pattern matches several; NULL: no
 * preference. *node receives the old model's node whose pattern is followed, or -1 if the pattern matches none there. For
 * ASSET_PATTERN_OTHER, *out receives the new pattern, which the caller frees with mem_free. */
enum asset_pattern_change asset_patterns_follow(struct asset_patterns *patterns, const char *pattern, const bool *before, int *node,
                                                char **out);

/* Updates an asset's node patterns to the new model. lines: one pattern per line. Returns the new patterns in the same form, or
 * NULL if none is left that matches a node. A pattern that matched several nodes keeps them all: exact patterns are added for
 * those that it no longer matches. A node leaves the asset only if it has another parent than the path pattern names, and another
 * asset gains it. If any pattern changed, (*nodes)[i] is the text that replaces pattern i, one pattern per line, or NULL if it is
 * deleted. The caller frees the result, each element of *nodes, and *nodes with mem_free. */
char *asset_patterns_update(struct asset_patterns *patterns, const char *lines, char ***nodes, size_t *node_count);

#endif
