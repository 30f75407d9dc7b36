/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Matches tags to equipment. Tries methods in order of certainty, from a model node with the tag's own name down to an alias,
 * and gives a reason for each match. Conflicting evidence lowers a match to "likely" or none. Call from any thread; one per
 * matcher while rules and aliases are read. */
#ifndef PREPROCESS_MATCH_MATCHER_H
#define PREPROCESS_MATCH_MATCHER_H
#include <regex.h>

#include "preprocess/match/model_index.h"
#include "preprocess/match/tag_export.h"

enum match_status { MATCH_NONE, MATCH_LIKELY, MATCH_SURE };
extern const char *const match_status_names[3];

enum { MATCH_CANDIDATES = 8 };

struct match {
    enum match_status status;
    /* asset: index of the matched asset; node: index of the asset's node that the tag's name refers to; -1: none */
    int asset, node;
    double confidence; /* confidence of the match, 0 to 1 */
    char *reason;      /* reason for the match, one line of English; the caller frees it */
    /* indices of assets that the tag may belong to if the match is not sure, likeliest first */
    int candidates[MATCH_CANDIDATES], candidate_count;
};

struct match_rule {  /* a site's rule: tags whose name matches the pattern belong to the equipment */
    regex_t pattern; /* POSIX extended regular expression, case-insensitive */
    char *equipment; /* name of the equipment, with \1 to \9 for groups of the pattern */
};

struct match_alias { /* an alias: a name that people use for an asset, split into tokens (runs of letters or digits) */
    struct name_tokens tokens;
    char *text;
    int asset;
};

struct matcher { /* zero-initialise */
    const struct model_index *site;
    struct match_rule *rules;
    struct match_alias *aliases;
    size_t rule_count, rule_room, alias_count, alias_room;
    char common_prefix[NAME_KEY_BYTES]; /* prefix before the instrument letters of most tag names, such as an area; "": none */
};

enum { MATCH_WHY_BYTES = 300 };

/* Reads the site's matching rules, a table with the columns `Tag` (a regular expression) and `Equipment`. Returns false with the reason in
 * why. */
bool matcher_read_rules(struct matcher *matcher, const char *path, char why[MATCH_WHY_BYTES]);
/* Reads aliases of equipment, a table with the columns `Alias` and `Equipment` (an asset's id or tag). Returns false with the reason in
 * why. */
bool matcher_read_aliases(struct matcher *matcher, const char *path, char why[MATCH_WHY_BYTES]);
/* Matches all tags of a list to equipment. Returns one match per tag; the caller frees them with matches_free(). */
struct match *matcher_run(struct matcher *matcher, const struct tag_export *list);
void matches_free(struct match *matches, size_t count); /* Frees the result of matcher_run(). matches may be NULL. */
void matcher_finish(struct matcher *matcher);
/* Returns the index of the asset whose id or tag is `name`, spelt exactly so or unambiguously similarly; -1: none. */
int matcher_find_asset(const struct matcher *matcher, const char *name);

#endif
