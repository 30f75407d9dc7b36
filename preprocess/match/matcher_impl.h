/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The methods that match a tag to equipment. Each proposes one asset, several that it cannot tell apart, or nothing. Included
 * only by matcher.c and match_*.c. Call from any thread. */
#ifndef PREPROCESS_MATCH_MATCHER_IMPL_H
#define PREPROCESS_MATCH_MATCHER_IMPL_H
#include "preprocess/match/isa.h"
#include "preprocess/match/matcher.h"

enum { CANDIDATES = 8, METHOD_REASON_BYTES = 240 };

struct match_candidates { /* list of distinct assets that a tag may belong to */
    int assets[CANDIDATES];
    /* by proposed asset: index of the asset's node that was found; -1: the asset itself was found, or several of its nodes */
    int nodes[CANDIDATES];
    int count;
    bool more; /* true: more assets were found than fit into the list */
};

struct proposal {
    struct match_candidates candidates; /* one asset: the one proposed; several assets: the method cannot tell them apart */
    double confidence;
    char reason[METHOD_REASON_BYTES];
};

struct match_subject { /* a tag to be matched, with its texts split into tokens (runs of letters or digits) */
    const struct export_tag *tag;
    struct isa_name name;
    struct name_tokens area, description;
};

void candidates_add(struct match_candidates *list, int asset, int node);
/* Adds the assets of all map entries with this key to the list. Returns whether the map has the key. */
bool candidates_find(struct match_candidates *list, const struct key_map *map, const char *key);
bool candidates_have(const struct match_candidates *list, int asset);
/* Writes the names of the listed assets as text, such as "E-101, P-101 or V-101". */
void candidates_name(const struct match_candidates *list, const struct model_index *site, char *text, size_t bytes);

/* Matching methods. Each returns true if it proposes one asset, or several that it cannot tell apart. */
bool method_own_node(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out);
bool method_rules(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out);
bool method_name_within(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out);
bool method_number(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out);
bool method_parts(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out);
bool method_spelling(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out);
bool method_attributes(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out);
bool method_description(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out);
bool method_words(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out);
bool method_alias(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out);

#endif
