/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs the methods that match a tag to equipment, in order, and decides between conflicting proposals. */
#include "preprocess/match/matcher.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/mem.h"
#include "base/text/text.h"
#include "base/text/charset.h"
#include "preprocess/match/matcher_impl.h"
#include "preprocess/match/table.h"

const char *const match_status_names[3] = { "none", "likely", "sure" };
static const double sure = 0.85, strong = 0.96;
static const size_t max_table_bytes = (size_t)16 << 20;

typedef bool (*match_method)(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out);
static const match_method methods[] = { method_own_node, method_rules,      method_name_within, method_parts, method_spelling,
                                        method_number,   method_attributes, method_description, method_words, method_alias };
enum { MIN_PREFIXES = 20 }; /* minimum number of tag names with a prefix; if there are fewer, no prefix counts as common to most names */
enum { METHODS = sizeof(methods) / sizeof(*methods) };

/* Returns whether two names differ in only one or two characters, so that one may be a misspelling of the other. */
static bool are_near(const char *a, const char *b)
{
    size_t differ = 0;
    if (strlen(a) != strlen(b))
        return false;
    for (; *a; a++, b++)
        differ += *a != *b;
    return differ <= 2;
}

static const char *id_of(const struct matcher *matcher, int asset)
{
    return matcher->site->plant->assets[asset].id;
}

/* Returns whether another method's sure proposal contradicts the chosen one. Only equipment with a nearly equal name
 * contradicts a strong proposal, such as a full name, because one of the two names may be misspelt. */
static bool contradicts(const struct matcher *matcher, const struct proposal *chosen, const struct proposal *other)
{
    int asset = chosen->candidates.assets[0];
    if (other->confidence < sure || candidates_have(&other->candidates, asset))
        return false;
    return chosen->confidence < strong ||
           (other->candidates.count == 1 && are_near(id_of(matcher, asset), id_of(matcher, other->candidates.assets[0])));
}

static void add_candidates(const struct match_candidates *list, struct match *out)
{
    for (int i = 0; i < list->count; i++) {
        bool there = false;
        for (int k = 0; k < out->candidate_count && !there; k++)
            there = out->candidates[k] == list->assets[i];
        if (!there && out->candidate_count < MATCH_CANDIDATES)
            out->candidates[out->candidate_count++] = list->assets[i];
    }
}

static void decide(const struct matcher *matcher, const struct proposal proposals[METHODS], struct match *out)
{
    struct text reason = { 0 };
    char names[200];
    /* indices of matching methods. chosen: the method whose proposal is accepted; -1: none. open: the first method that
     * proposed several assets; -1: none */
    int chosen = -1, open = -1;
    /* The first pass accepts only proposals that their method marks as sure, the second pass all proposals. */
    for (int pass = 0; pass < 2 && chosen < 0; pass++)
        for (int i = 0; i < METHODS && chosen < 0; i++) {
            const struct proposal *proposal = &proposals[i];
            if (proposal->candidates.count == 1 && !proposal->candidates.more && (pass == 1 || proposal->confidence >= sure))
                chosen = i;
        }
    for (int i = 0; i < (chosen < 0 ? METHODS : chosen) && open < 0; i++)
        if (proposals[i].candidates.count > 1 && (chosen < 0 || proposals[i].confidence >= sure))
            open = i;
    if (chosen < 0) {
        if (open >= 0) {
            candidates_name(&proposals[open].candidates, matcher->site, names, sizeof(names));
            text_add(&reason, "%s: %s", proposals[open].reason, names);
        } else {
            text_add(&reason, "no match: no node of the model has the name, number or words of the tag");
        }
    } else {
        const struct proposal *of = &proposals[chosen];
        out->asset = of->candidates.assets[0];
        out->node = of->candidates.nodes[0];
        out->confidence = of->confidence;
        text_add(&reason, "%s", of->reason);
        if (open >= 0 && candidates_have(&proposals[open].candidates, out->asset)) {
            text_add(&reason, "; %s", proposals[open].reason);
        } else if (open >= 0) {
            candidates_name(&proposals[open].candidates, matcher->site, names, sizeof(names));
            text_add(&reason, ", but %s: %s", proposals[open].reason, names);
            out->confidence = 0.5;
        }
        for (int i = chosen + 1; i < METHODS && out->confidence > 0.5; i++)
            if (proposals[i].candidates.count > 0 && contradicts(matcher, of, &proposals[i])) {
                text_add(&reason, ", but %s (%s)", proposals[i].reason, id_of(matcher, proposals[i].candidates.assets[0]));
                out->confidence = 0.5;
            } else if (proposals[i].candidates.count == 1 && proposals[i].candidates.assets[0] == out->asset && out->confidence < sure &&
                       proposals[i].confidence >= sure) {
                text_add(&reason, "; %s", proposals[i].reason);
                out->confidence = proposals[i].confidence;
            }
        out->status = out->confidence >= sure ? MATCH_SURE : MATCH_LIKELY;
        add_candidates(&of->candidates, out);
    }
    for (int i = 0; i < METHODS; i++)
        add_candidates(&proposals[i].candidates, out);
    if (out->status == MATCH_SURE)
        out->candidate_count = 0;
    out->reason = mem_strdup(reason.at);
    text_finish(&reason);
}

static void match_one(const struct matcher *matcher, const struct export_tag *tag, struct match *out)
{
    struct match_subject subject = { .tag = tag };
    struct proposal proposals[METHODS];
    memset(proposals, 0, sizeof(proposals));
    *out = (struct match){ .asset = -1, .node = -1 };
    isa_read(&subject.name, tag->fields[EXPORT_NAME]);
    name_tokens_read(&subject.area, tag->fields[EXPORT_AREA]);
    name_tokens_read(&subject.description, tag->fields[EXPORT_DESCRIPTION]);
    for (int i = 0; i < METHODS; i++)
        methods[i](matcher, &subject, &proposals[i]);
    decide(matcher, proposals, out);
}

/* --- finding the prefix that most tag names have -------------------------------------------------------------------------- */

static int by_text(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static void find_common_prefix(struct matcher *matcher, const struct tag_export *list)
{
    char **prefixes = mem_array(list->count, sizeof(*prefixes)), key[NAME_KEY_BYTES];
    size_t count = 0;
    for (size_t i = 0; i < list->count; i++) {
        struct isa_name name;
        isa_read(&name, list->tags[i].fields[EXPORT_NAME]);
        if (name.letters <= 0)
            continue;
        name_tokens_key(&name.tokens, 0, name.letters, key);
        prefixes[count++] = mem_strdup(key);
    }
    qsort(prefixes, count, sizeof(*prefixes), by_text);
    matcher->common_prefix[0] = 0;
    for (size_t i = 0, end; i < count; i = end) {
        for (end = i + 1; end < count && !strcmp(prefixes[i], prefixes[end]); end++)
            ;
        if (count >= MIN_PREFIXES && (end - i) * 10 >= count * 6)
            snprintf(matcher->common_prefix, sizeof(matcher->common_prefix), "%s", prefixes[i]);
    }
    for (size_t i = 0; i < count; i++)
        mem_free(prefixes[i]);
    mem_free(prefixes);
}

struct match *matcher_run(struct matcher *matcher, const struct tag_export *list)
{
    struct match *matches = mem_array(list->count, sizeof(*matches));
    find_common_prefix(matcher, list);
    for (size_t i = 0; i < list->count; i++)
        match_one(matcher, &list->tags[i], &matches[i]);
    return matches;
}

void matches_free(struct match *matches, size_t count)
{
    for (size_t i = 0; i < count && matches; i++)
        mem_free(matches[i].reason);
    mem_free(matches);
}

/* --- rules and aliases ------------------------------------------------------------------------------------------------------ */

static bool read_table(struct cell_table *table, const char *path, const char *first, const char *second, char why[MATCH_WHY_BYTES])
{
    size_t count;
    char *bytes = text_read_file(path, max_table_bytes, &count), reason[200];
    struct charset_text text;
    bool good = bytes != NULL;
    if (!good)
        snprintf(why, MATCH_WHY_BYTES, "%s", strerror(errno));
    if (good) {
        charset_decode(bytes, count, NULL, &text);
        good = table_read_csv(table, text.utf8, table_separator(text.utf8), reason, sizeof(reason));
        if (!good)
            snprintf(why, MATCH_WHY_BYTES, "%s", reason);
        mem_free(text.utf8);
    }
    mem_free(bytes);
    if (good && (table->count == 0 || strcasecmp(table_cell(&table->rows[0], 0), first) != 0 ||
                 strcasecmp(table_cell(&table->rows[0], 1), second) != 0)) {
        snprintf(why, MATCH_WHY_BYTES, "line 1: expected the columns %s,%s", first, second);
        good = false;
    }
    return good;
}

bool matcher_read_rules(struct matcher *matcher, const char *path, char why[MATCH_WHY_BYTES])
{
    struct cell_table table = { 0 };
    bool good = read_table(&table, path, "Tag", "Equipment", why);
    for (size_t i = 1; i < table.count && good; i++) {
        mem_grow(&matcher->rules, &matcher->rule_room, matcher->rule_count + 1, sizeof(*matcher->rules));
        struct match_rule *rule = &matcher->rules[matcher->rule_count];
        char reason[120];
        int error = regcomp(&rule->pattern, table_cell(&table.rows[i], 0), REG_EXTENDED | REG_ICASE);
        if (error) {
            regerror(error, &rule->pattern, reason, sizeof(reason));
            snprintf(why, MATCH_WHY_BYTES, "line %d: column Tag: '%.80s' is not a valid regular expression: %s", table.rows[i].line,
                     table_cell(&table.rows[i], 0), reason);
            good = false;
        } else {
            rule->equipment = mem_strdup(table_cell(&table.rows[i], 1));
            matcher->rule_count++;
        }
    }
    table_finish(&table);
    return good;
}

bool matcher_read_aliases(struct matcher *matcher, const char *path, char why[MATCH_WHY_BYTES])
{
    struct cell_table table = { 0 };
    bool good = read_table(&table, path, "Alias", "Equipment", why);
    for (size_t i = 1; i < table.count && good; i++) {
        const char *text = table_cell(&table.rows[i], 0), *equipment = table_cell(&table.rows[i], 1);
        int asset = matcher_find_asset(matcher, equipment);
        if (asset < 0) {
            snprintf(why, MATCH_WHY_BYTES, "line %d: column Equipment: no asset of the plant is called '%.80s'", table.rows[i].line,
                     equipment);
            good = false;
            break;
        }
        mem_grow(&matcher->aliases, &matcher->alias_room, matcher->alias_count + 1, sizeof(*matcher->aliases));
        struct match_alias *alias = &matcher->aliases[matcher->alias_count++];
        *alias = (struct match_alias){ .text = mem_strdup(text), .asset = asset };
        name_tokens_read(&alias->tokens, text);
    }
    table_finish(&table);
    return good;
}

void matcher_finish(struct matcher *matcher)
{
    for (size_t i = 0; i < matcher->rule_count; i++) {
        regfree(&matcher->rules[i].pattern);
        mem_free(matcher->rules[i].equipment);
    }
    for (size_t i = 0; i < matcher->alias_count; i++)
        mem_free(matcher->aliases[i].text);
    mem_free(matcher->rules);
    mem_free(matcher->aliases);
    *matcher = (struct matcher){ 0 };
}
