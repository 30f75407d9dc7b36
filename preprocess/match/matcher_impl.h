/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The ways to match a tag. Each proposes one asset, or several that it cannot tell apart, or nothing. For matcher.c and match_*.c only.
 * Thread: any. */
#ifndef PREPROCESS_MATCH_MATCHER_IMPL_H
#define PREPROCESS_MATCH_MATCHER_IMPL_H
#include "preprocess/match/isa.h"
#include "preprocess/match/matcher.h"

enum { CANDIDATES = 8, WAY_REASON_BYTES = 240 };

struct match_candidates { /* assets, each once */
    int assets[CANDIDATES];
    int nodes[CANDIDATES]; /* of the first thing that was found of the asset; -1: the asset itself, or several nodes */
    int count;
    bool more; /* than are listed */
};

struct proposal {
    struct match_candidates candidates; /* one: proposed; several: one of these */
    double confidence;
    char reason[WAY_REASON_BYTES];
};

struct match_subject { /* a tag, taken apart */
    const struct export_tag *tag;
    struct isa_name name;
    struct name_tokens area, description;
};

void candidates_add(struct match_candidates *list, int asset, int node);
/* Adds all things of the map that have the key. Returns whether there are any. */
bool candidates_find(struct match_candidates *list, const struct key_map *map, const char *key);
bool candidates_have(const struct match_candidates *list, int asset);
/* Writes "E-101, P-101 or V-101". */
void candidates_name(const struct match_candidates *list, const struct model_index *site, char *text, size_t bytes);

/* Each returns whether it has a proposal. */
bool way_own_node(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out);
bool way_rules(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out);
bool way_name_within(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out);
bool way_number(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out);
bool way_parts(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out);
bool way_spelling(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out);
bool way_attributes(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out);
bool way_description(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out);
bool way_words(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out);
bool way_alias(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out);

#endif
