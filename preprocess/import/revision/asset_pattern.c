/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the model nodes that a pattern matches: looks up plain names in a sorted list, and tests all nodes against other patterns. */
#include "preprocess/import/revision/asset_pattern.h"

#include <fnmatch.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/math/search.h"
#include "base/mem.h"
#include "base/text/text.h"

static int by_name(const void *a, const void *b, void *header_ptr)
{
    const struct model_header *header = header_ptr;
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    int order = strcmp(header->nodes[x].name, header->nodes[y].name);
    return order ? order : (x > y) - (x < y);
}

static uint32_t *sorted_names(const struct model_header *header)
{
    uint32_t *nodes = mem_array(header->count + 1, sizeof(*nodes));
    for (size_t i = 0; i < header->count; i++)
        nodes[i] = (uint32_t)i;
    qsort_r(nodes, header->count, sizeof(*nodes), by_name, (void *)(uintptr_t)header);
    return nodes;
}

void asset_patterns_init(struct asset_patterns *patterns, const struct model_header *before, const struct model_header *after,
                         const struct node_pairs *pairs)
{
    size_t most = before->count > after->count ? before->count : after->count;
    *patterns = (struct asset_patterns){ .before = before,
                                         .after = after,
                                         .pairs = pairs,
                                         .old_names = sorted_names(before),
                                         .new_names = sorted_names(after),
                                         .found = mem_array(most + 1, sizeof(*patterns->found)),
                                         .gained = mem_array(after->count + 1, sizeof(*patterns->gained)) };
}

void asset_patterns_finish(struct asset_patterns *patterns)
{
    mem_free(patterns->old_names);
    mem_free(patterns->new_names);
    mem_free(patterns->found);
    mem_free(patterns->gained);
    *patterns = (struct asset_patterns){ 0 };
}

/* Returns the index, in the nodes sorted by name, of the first node with this name; *count receives the number of such nodes. */
static size_t find_name(const struct model_header *header, const uint32_t *names, const char *name, size_t *count)
{
    size_t at;
    search_sorted(at, header->count, strcmp(header->nodes[names[at]].name, name) < 0);
    *count = 0;
    while (at + *count < header->count && !strcmp(header->nodes[names[at + *count]].name, name))
        ++*count;
    return at;
}

/* Fills patterns->found with the indices of the nodes that the pattern matches. Returns their number. */
static size_t find(struct asset_patterns *patterns, const struct model_header *header, const uint32_t *names, const char *pattern)
{
    size_t count, first = find_name(header, names, pattern, &count);
    char why[200];
    if (count == 0 && (pattern[strcspn(pattern, "*?[/")] || pattern[0] == '#' || !strncmp(pattern, "mesh:", 5)))
        return nodes_find(pattern, header->nodes, header->count, patterns->found, why, sizeof(why));
    if (count > 0)
        memcpy(patterns->found, names + first, count * sizeof(*names));
    return count;
}

/* Returns a pattern that matches only this node of the new model: its name if that is unique, else "#number". */
static char *exact_pattern(struct asset_patterns *patterns, uint32_t node)
{
    const char *name = patterns->after->nodes[node].name;
    struct text printable = { 0 };
    model_outline_add_printable(&printable, name);
    bool usable = *name && printable.at && !strcmp(printable.at, name) && name[0] != '!' && name[0] != '#' &&
                  find(patterns, patterns->after, patterns->new_names, name) == 1;
    text_finish(&printable);
    return usable ? mem_strdup(name) : mem_printf("#%u", patterns->after->nodes[node].number);
}

enum asset_pattern_change asset_patterns_follow(struct asset_patterns *patterns, const char *pattern, const bool *before, int *node,
                                                char **out)
{
    size_t old_count = find(patterns, patterns->before, patterns->old_names, pattern);
    *node = old_count > 0 ? (int)patterns->found[0] : -1;
    for (size_t i = 0; before && i < old_count; i++)
        if (before[patterns->found[i]]) {
            *node = (int)patterns->found[i];
            break;
        }
    int other = *node >= 0 ? patterns->pairs->to_new[*node] : -1;
    size_t new_count = find(patterns, patterns->after, patterns->new_names, pattern);
    bool numbered = pattern[0] == '#', still = false;
    for (size_t i = 0; i < new_count; i++)
        still |= patterns->found[i] == (uint32_t)other;
    if (other >= 0 && !still) {
        *out = numbered ? mem_printf("#%u", patterns->after->nodes[other].number) : exact_pattern(patterns, (uint32_t)other);
        return ASSET_PATTERN_OTHER;
    }
    return new_count > 0 && (still || !numbered) ? ASSET_PATTERN_SAME : ASSET_PATTERN_GONE;
}

static void mark(const struct model_header *header, uint32_t node, bool *marked)
{
    for (size_t i = node; i < header->nodes[node].end; i++)
        marked[i] = true;
}

/* Sets *marked for each node that an asset's paths and wildcards select. Ignores plain names and numbers, which
 * asset_patterns_update() rewrites. */
static void select_nodes(struct asset_patterns *patterns, const struct model_header *header, const uint32_t *names, const char *lines,
                         bool *marked)
{
    for (int excludes = 0; excludes < 2; excludes++) {
        char *copy = mem_strdup(lines), *next = copy;
        for (char *line = strsep(&next, "\n"); line; line = strsep(&next, "\n")) {
            if ((line[0] == '!') != excludes || (!excludes && !strpbrk(line, "*?[/")))
                continue;
            size_t count = find(patterns, header, names, line + excludes);
            for (size_t i = 0; i < count; i++)
                memset(marked + patterns->found[i], !excludes, header->nodes[patterns->found[i]].end - patterns->found[i]);
        }
        mem_free(copy);
    }
}

void asset_patterns_add_gained(struct asset_patterns *patterns, const char *lines)
{
    if (!strpbrk(lines, "*?[/"))
        return;
    bool *was = mem_array(patterns->before->count + 1, sizeof(*was)), *is = mem_array(patterns->after->count + 1, sizeof(*is));
    select_nodes(patterns, patterns->before, patterns->old_names, lines, was);
    select_nodes(patterns, patterns->after, patterns->new_names, lines, is);
    for (size_t i = 0; i < patterns->after->count; i++) {
        int old = patterns->pairs->to_old[i];
        patterns->gained[i] |= is[i] && old >= 0 && !was[old];
    }
    mem_free(was);
    mem_free(is);
}

static void add_line(struct text *out, const char *sign, const char *pattern)
{
    text_add(out, "%s%s%s", out->length > 0 ? "\n" : "", sign, pattern);
}

/* Returns the nearest ancestor that has a counterpart in the other model, or -1. */
static int paired_ancestor(const struct model_header *header, const int *pairs, int node)
{
    do
        node = header->nodes[node].parent;
    while (node >= 0 && pairs[node] < 0);
    return node;
}

/* Returns whether `pattern`, which matches a node with this name, names the node's ancestors (nodes.c). */
static bool is_path(const char *pattern, const char *name)
{
    return strchr(pattern, '/') && strncmp(pattern, "mesh:", 5) != 0 && strcmp(pattern, name) != 0 && fnmatch(pattern, name, 0) != 0;
}

/* Returns whether one of the ancestors that a path pattern names has become another node. Ignores ancestors that only one of the
 * models has: these were renamed, added or removed. */
static bool has_other_ancestor(const struct asset_patterns *patterns, const char *pattern, uint32_t node)
{
    int from = (int)node, to = patterns->pairs->to_new[node];
    bool any_depth = strstr(pattern, "**");
    for (const char *slash = strchr(pattern, '/'); slash; slash = any_depth ? slash : strchr(slash + 1, '/')) {
        from = paired_ancestor(patterns->before, patterns->pairs->to_new, from);
        to = paired_ancestor(patterns->after, patterns->pairs->to_old, to);
        if (from < 0 || to < 0 || patterns->pairs->to_new[from] != to)
            return from >= 0 || to >= 0;
    }
    return false;
}

/* Returns flags of the nodes of the new model whose ancestors match a path pattern, whatever the nodes' own names are. */
static bool *find_below(struct asset_patterns *patterns, const char *pattern)
{
    bool *below = mem_array(patterns->after->count + 1, sizeof(*below));
    char *any = mem_printf("%.*s*", (int)(strrchr(pattern, '/') + 1 - pattern), pattern);
    size_t count = find(patterns, patterns->after, patterns->new_names, any);
    for (size_t i = 0; i < count; i++)
        below[patterns->found[i]] = true;
    mem_free(any);
    return below;
}

/* Returns whether a node that moved away from the ancestors that a path pattern names now belongs to another asset. *below keeps the
 * result of find_below() for the next node of the pattern; NULL at first. The caller frees it. */
static bool has_left(struct asset_patterns *patterns, const char *pattern, uint32_t node, bool **below)
{
    int other = patterns->pairs->to_new[node];
    if (other < 0 || !patterns->gained[other] || !is_path(pattern, patterns->before->nodes[node].name) ||
        !has_other_ancestor(patterns, pattern, node))
        return false;
    *below = *below ? *below : find_below(patterns, pattern);
    return !(*below)[other];
}

/* Adds the patterns that match, in the new model, the counterparts of all nodes that `pattern` matches in the old model: the pattern
 * itself if it still matches a node, and an exact pattern for each counterpart that it no longer matches. Does not add nodes that
 * have left an asset for another one. */
static void follow_several(struct asset_patterns *patterns, const char *pattern, const char *sign, struct text *out)
{
    size_t old_count = find(patterns, patterns->before, patterns->old_names, pattern);
    uint32_t *olds = mem_array(old_count, sizeof(*olds));
    bool *matched = mem_array(patterns->after->count + 1, sizeof(*matched)), *below = NULL;
    memcpy(olds, patterns->found, old_count * sizeof(*olds));
    size_t new_count = find(patterns, patterns->after, patterns->new_names, pattern);
    for (size_t i = 0; i < new_count; i++)
        mark(patterns->after, patterns->found[i], matched);
    if (new_count > 0)
        add_line(out, sign, pattern);
    for (size_t i = 0; i < old_count; i++) {
        int other = patterns->pairs->to_new[olds[i]];
        if (other < 0 || matched[other] || (!*sign && has_left(patterns, pattern, olds[i], &below)))
            continue;
        char *exact = exact_pattern(patterns, (uint32_t)other);
        add_line(out, sign, exact);
        mark(patterns->after, (uint32_t)other, matched);
        mem_free(exact);
    }
    mem_free(olds);
    mem_free(matched);
    mem_free(below);
}

/* Returns what replaces one line of an asset's patterns: one pattern per line, or NULL if none matches a node of the new model. */
static char *follow_line(struct asset_patterns *patterns, const char *line)
{
    const char *sign = line[0] == '!' ? "!" : "", *pattern = line + strlen(sign);
    struct text out = { 0 };
    char *other = NULL;
    bool *below = NULL;
    int node;
    size_t old_count = find(patterns, patterns->before, patterns->old_names, pattern);
    bool has_moved = old_count == 1 && !*sign && has_left(patterns, pattern, patterns->found[0], &below);
    mem_free(below);
    if (old_count > 1 || has_moved) {
        follow_several(patterns, pattern, sign, &out);
        return out.at;
    }
    enum asset_pattern_change change = asset_patterns_follow(patterns, pattern, NULL, &node, &other);
    if (change != ASSET_PATTERN_GONE)
        add_line(&out, sign, change == ASSET_PATTERN_OTHER ? other : pattern);
    mem_free(other);
    return out.at;
}

char *asset_patterns_update(struct asset_patterns *patterns, const char *lines, char ***nodes, size_t *node_count)
{
    struct text out = { 0 };
    bool changed = false, taking = false, had_taking = false;
    char **list = NULL, *copy = mem_strdup(lines), *next = copy;
    size_t count = 0, room = 0;
    for (char *line = strsep(&next, "\n"); line; line = strsep(&next, "\n")) {
        char *now = follow_line(patterns, line);
        changed |= !now || strcmp(now, line) != 0;
        had_taking |= line[0] != '!';
        taking |= now && line[0] != '!';
        if (now)
            add_line(&out, "", now);
        mem_grow(&list, &room, count + 1, sizeof(*list));
        list[count++] = now;
    }
    mem_free(copy);
    bool none = out.length == 0 || (had_taking && !taking);
    if (changed && !none) {
        *nodes = list;
        *node_count = count;
        return out.at;
    }
    for (size_t i = 0; i < count; i++)
        mem_free(list[i]);
    mem_free(list);
    if (none)
        text_finish(&out);
    return out.at;
}
