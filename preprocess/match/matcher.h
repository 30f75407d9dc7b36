/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Matches tags to equipment: tries ways in order, from a node of the tag's own name to an alias, and says why. What contradicts itself is
 * not decided. Thread: any; one per matcher while rules and aliases are read. */
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
    int asset, node;                                   /* -1: none. A node below the asset's own: where the tag is by its name */
    double confidence;                                 /* 0 to 1 */
    char *reason;                                      /* one line of English; the caller frees it */
    int candidates[MATCH_CANDIDATES], candidate_count; /* of what is not sure: assets that it may be, the likeliest first */
};

struct match_rule {  /* of the site: tags of this form are of that equipment */
    regex_t pattern; /* POSIX extended, upper and lower case taken as one */
    char *equipment; /* with \1 to \9 */
};

struct match_alias { /* what people call an asset, as tokens */
    struct name_tokens tokens;
    char *text;
    int asset;
};

struct matcher { /* zero-initialise */
    const struct model_index *site;
    struct match_rule *rules;
    struct match_alias *aliases;
    size_t rule_count, rule_room, alias_count, alias_room;
    char common_prefix[NAME_KEY_BYTES]; /* what most names have before their letters, such as an area; "" where there is none */
};

enum { MATCH_WHY_BYTES = 300 };

/* Reads rules, a table of two columns: `Tag`, a regular expression, and `Equipment`. Returns false with the reason. */
bool matcher_read_rules(struct matcher *matcher, const char *path, char why[MATCH_WHY_BYTES]);
/* Reads aliases, a table of two columns: `Alias` and `Equipment`, an asset's id or tag. Returns false with the reason. */
bool matcher_read_aliases(struct matcher *matcher, const char *path, char why[MATCH_WHY_BYTES]);
/* Matches all tags of a list. Returns one match for each; the caller frees them (matches_free). */
struct match *matcher_run(struct matcher *matcher, const struct tag_export *list);
void matches_free(struct match *matches, size_t count); /* NULL is fine */
void matcher_finish(struct matcher *matcher);
/* Returns the asset that a name means, by id, tag or an unambiguous spelling of these; -1: none. */
int matcher_find_asset(const struct matcher *matcher, const char *name);

#endif
