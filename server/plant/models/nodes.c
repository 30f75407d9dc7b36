/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Matches node patterns against the nodes of a model: by name, by index in the file (#12), by the name of a mesh, or by path (names of a
   node and its parents). */
#include "plant/models/nodes.h"

#include <fnmatch.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/utf8.h"
#include "plant/parse/suggest.h"

#define MESH_PREFIX "mesh:"
enum { SEGMENTS_MAX = 64 };

enum pattern_kind { NAME, GLOB, NUMBER, MESH, PATH };

struct pattern {
    enum pattern_kind kind;
    bool excludes;
    char *text; /* the pattern without its prefixes ! and mesh:; cut_path() replaces the slashes of a path by NUL */
    uint64_t number;
    bool from_root; /* true: the pattern is a path that begins with a slash, so it starts at the scene's root */
    const char *segments[SEGMENTS_MAX];
    size_t segment_count;
};

struct node_list {
    const struct model_node *nodes;
    size_t count;
};

static bool any_named(const struct node_list *model, const char *name)
{
    for (size_t i = 0; i < model->count; i++)
        if (strcmp(name, model->nodes[i].name) == 0)
            return true;
    return false;
}

static bool any_like(const struct node_list *model, const char *glob)
{
    for (size_t i = 0; i < model->count; i++)
        if (fnmatch(glob, model->nodes[i].name, 0) == 0)
            return true;
    return false;
}

static bool is_number(const char *text)
{
    return *text == '#' && text[1] && strlen(text) < 12 && strspn(text + 1, "0123456789") == strlen(text + 1);
}

static void cut_path(struct pattern *pattern)
{
    char *at = pattern->text;
    pattern->from_root = *at == '/';
    at += pattern->from_root;
    while (at && pattern->segment_count < SEGMENTS_MAX) {
        char *slash = strchr(at, '/');
        pattern->segments[pattern->segment_count++] = at;
        if (slash)
            *slash++ = 0;
        at = slash;
    }
}

/* Parses a pattern. A text that equals the name of a node always means that node, whatever special characters it contains. */
static void pattern_init(struct pattern *pattern, const char *text, const struct node_list *model)
{
    bool named = any_named(model, text);
    *pattern = (struct pattern){ .excludes = !named && *text == '!' };
    text += pattern->excludes;
    named = named || (pattern->excludes && any_named(model, text));
    if (named) {
        pattern->kind = NAME;
    } else if (is_number(text)) {
        pattern->kind = NUMBER;
        pattern->number = strtoull(text + 1, NULL, 10);
    } else if (strncmp(text, MESH_PREFIX, strlen(MESH_PREFIX)) == 0) {
        pattern->kind = MESH;
        text += strlen(MESH_PREFIX);
    } else if (strchr(text, '/') && !any_like(model, text)) {
        pattern->kind = PATH;
    } else {
        pattern->kind = GLOB;
    }
    pattern->text = mem_strdup(text);
    if (pattern->kind == PATH)
        cut_path(pattern);
}

static void pattern_finish(struct pattern *pattern)
{
    mem_free(pattern->text);
}

static bool is_instance(const struct model_node *nodes, int node)
{
    return nodes[node].parent >= 0 && nodes[nodes[node].parent].number == nodes[node].number;
}

/* Returns whether the first `left` segments of a path pattern match the names of the nodes on the path from the root to this node (-1: the
   scene itself). */
static bool path_matches(const struct pattern *pattern, size_t left, const struct model_node *nodes, int node)
{
    if (left == 0)
        return !pattern->from_root || node < 0;
    const char *segment = pattern->segments[left - 1];
    bool any_depth = strcmp(segment, "**") == 0;
    if (any_depth && path_matches(pattern, left - 1, nodes, node))
        return true;
    if (node < 0)
        return false;
    if (any_depth)
        return path_matches(pattern, left, nodes, nodes[node].parent);
    return (strcmp(segment, nodes[node].name) == 0 || fnmatch(segment, nodes[node].name, 0) == 0) &&
           path_matches(pattern, left - 1, nodes, nodes[node].parent);
}

static bool matches(const struct pattern *pattern, const struct model_node *nodes, size_t i)
{
    const struct model_node *node = &nodes[i];
    switch (pattern->kind) {
    case NAME: return strcmp(pattern->text, node->name) == 0;
    case GLOB: return fnmatch(pattern->text, node->name, 0) == 0;
    case NUMBER: return node->number == pattern->number;
    case MESH: return *node->mesh && (strcmp(pattern->text, node->mesh) == 0 || fnmatch(pattern->text, node->mesh, 0) == 0);
    case PATH: return !is_instance(nodes, (int)i) && path_matches(pattern, pattern->segment_count, nodes, (int)i);
    }
    return false;
}

/* --- messages for patterns that match no node --------------------------------------------------------------------------------- */

static const char *near_mesh(const char *text, const struct node_list *model)
{
    const char **names = mem_array(model->count, sizeof(*names)), *near;
    for (size_t i = 0; i < model->count; i++)
        names[i] = model->nodes[i].mesh;
    near = suggest_nearest(text, names, model->count, sizeof(*names));
    mem_free(names);
    return near;
}

static bool is_mesh(const char *text, const struct node_list *model)
{
    for (size_t i = 0; i < model->count; i++)
        if (strcmp(text, model->nodes[i].mesh) == 0)
            return true;
    return false;
}

/* Writes ": did you mean ...?" with the name most similar to the pattern, or nothing if no name is similar. */
static void suggest(const struct pattern *pattern, const struct node_list *model, char *out, size_t bytes)
{
    const char *text = pattern->kind == PATH ? pattern->segments[pattern->segment_count - 1] : pattern->text;
    bool by_mesh = pattern->kind == MESH || (pattern->kind == GLOB && is_mesh(text, model));
    const char *near = NULL;
    if (by_mesh)
        near = is_mesh(text, model) ? text : near_mesh(text, model);
    else if (pattern->kind != NUMBER)
        near = suggest_nearest(text, model->nodes, model->count, sizeof(*model->nodes));
    *out = 0;
    if (near && !(pattern->kind == PATH && strcmp(near, text) == 0))
        snprintf(out, bytes, ": did you mean '%s%.120s'?", by_mesh ? MESH_PREFIX : "", near);
}

static void say_none(const struct pattern *pattern, const char *text, const struct node_list *model, char *why, size_t bytes)
{
    static const char *const forms[] = { [NAME] = "no node's name matches '%.120s'%s",
                                         [GLOB] = "no node's name matches '%.120s'%s",
                                         [NUMBER] = "the scene has no node '%.120s'%s",
                                         [MESH] = "no node's mesh has a name that matches '%.120s'%s",
                                         [PATH] = "no node's name or path matches '%.120s'%s" };
    char near[160];
    suggest(pattern, model, near, sizeof(near));
    snprintf(why, bytes, forms[pattern->kind], text, near);
    utf8_drop_invalid(why); /* shortened names may end inside a character */
}

/* --- applying patterns -------------------------------------------------------------------------------------------------------- */

/* Sets marks[i] to `value` for each node i of the model that matches the pattern. Returns false if no node matches. */
static bool mark(const struct pattern *pattern, const struct node_list *model, bool *marks, bool value)
{
    bool any = false;
    for (size_t i = 0; i < model->count;) {
        if (!matches(pattern, model->nodes, i)) {
            i++;
            continue;
        }
        any = true;
        for (size_t end = model->nodes[i].end; i < end; i++)
            marks[i] = value;
    }
    return any;
}

/* Applies either the patterns that include nodes, or those that exclude nodes (with !), to the flags `taken`. Adds the number
   of applied patterns to *done. Returns false with the reason in `why` if a pattern matches no node. */
static bool mark_all(const char *patterns, bool excludes, const struct node_list *model, bool *taken, size_t *done, char *why, size_t bytes)
{
    bool good = true;
    char *copy = mem_strdup(patterns), *next = copy;
    for (char *text = strsep(&next, (char[]){ NODES_SEPARATOR, 0 }); text && good; text = strsep(&next, (char[]){ NODES_SEPARATOR, 0 })) {
        struct pattern pattern;
        pattern_init(&pattern, text, model);
        if (pattern.excludes == excludes) {
            good = mark(&pattern, model, taken, !excludes);
            if (!good)
                say_none(&pattern, text, model, why, bytes);
            ++*done;
        }
        pattern_finish(&pattern);
    }
    mem_free(copy);
    return good;
}

bool nodes_take(const char *patterns, const struct model_node *nodes, size_t count, bool *taken, char *why, size_t why_bytes)
{
    const struct node_list model = { nodes, count };
    size_t including = 0, excluding = 0;
    memset(taken, 0, count * sizeof(*taken));
    bool good = !patterns || mark_all(patterns, false, &model, taken, &including, why, why_bytes);
    if (good && including == 0)
        /* no pattern includes nodes, so all nodes are included before the excluding patterns are applied */
        memset(taken, 1, count * sizeof(*taken));
    return good && (!patterns || mark_all(patterns, true, &model, taken, &excluding, why, why_bytes));
}

size_t nodes_find(const char *pattern, const struct model_node *nodes, size_t count, uint32_t *found, char *why, size_t why_bytes)
{
    const struct node_list model = { nodes, count };
    struct pattern one;
    size_t found_count = 0;
    pattern_init(&one, pattern, &model);
    for (size_t i = 0; i < count && !one.excludes; i++)
        if (!is_instance(nodes, (int)i) && matches(&one, nodes, i))
            found[found_count++] = (uint32_t)i;
    if (found_count == 0) {
        char near[160];
        suggest(&one, &model, near, sizeof(near));
        snprintf(why, why_bytes, "the model has no node '%.200s'%s", pattern, near);
        utf8_drop_invalid(why); /* shortened names may end inside a character */
    }
    pattern_finish(&one);
    return found_count;
}
