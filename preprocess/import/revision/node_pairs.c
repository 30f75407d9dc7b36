/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pairs the nodes of an old and a new model by several methods, from the most to the least certain. A pair, once made, is never changed. */
#include "preprocess/import/revision/node_pairs.h"

#include <stdlib.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"

struct node_pairing {
    const struct model_outline *old_outline, *new_outline;
    struct node_pairs *pairs;
    int *olds, *news; /* unpaired nodes of the old and the new model that the current method compares; each array has room for all nodes */
    size_t old_count, new_count;
};

static void pair(struct node_pairing *p, int old_node, int new_node)
{
    p->pairs->to_new[old_node] = new_node;
    p->pairs->to_old[new_node] = old_node;
}

/* --- likeness ----------------------------------------------------------------------------------------------------------------- */

static double extent_of(const struct model_box *box)
{
    double size[3];
    vec_sub(box->high, box->low, size);
    return vec_length(size);
}

static bool shows(const struct outline_node *node)
{
    return node->all.low[0] <= node->all.high[0];
}

static bool in_same_place(const struct outline_node *a, const struct outline_node *b)
{
    double tolerance = extent_of(&a->all) * 1e-3;
    return shows(a) && shows(b) && vec_distance(a->all.low, b->all.low) <= tolerance && vec_distance(a->all.high, b->all.high) <= tolerance;
}

static size_t size_of(const struct model_outline *outline, int node)
{
    return outline->header.nodes[node].end - (size_t)node;
}

/* --- lists -------------------------------------------------------------------------------------------------------------------- */

static int by_name(const void *a, const void *b, void *outline_ptr)
{
    const struct model_outline *outline = outline_ptr;
    int x = *(const int *)a, y = *(const int *)b, order = strcmp(outline->nodes[x].name, outline->nodes[y].name);
    return order ? order : x - y;
}

/* Compares nodes by the size of their subtree. Ignores triangle counts, which differ if covered faces were left out of one model. */
static int by_size(const void *a, const void *b, void *outline_ptr)
{
    const struct model_outline *outline = outline_ptr;
    int x = *(const int *)a, y = *(const int *)b;
    size_t x_size = size_of(outline, x), y_size = size_of(outline, y);
    return x_size != y_size ? (x_size < y_size ? -1 : 1) : x - y;
}

static size_t children_of(const struct model_outline *outline, const int *paired, int parent, int *out)
{
    size_t count = 0;
    size_t end = parent < 0 ? outline->header.count : outline->header.nodes[parent].end;
    for (size_t i = (size_t)(parent + 1); i < end; i = outline->header.nodes[i].end)
        if (paired[i] < 0)
            out[count++] = (int)i;
    return count;
}

static void take_children(struct node_pairing *p, int old_parent, int new_parent)
{
    p->old_count = children_of(p->old_outline, p->pairs->to_new, old_parent, p->olds);
    p->new_count = children_of(p->new_outline, p->pairs->to_old, new_parent, p->news);
}

/* Lists the unpaired nodes whose name occurs only once in their model. Paired nodes count too: a repeated name such as "Pump"
 * identifies no node. Writes to `out`, which has room for all nodes; returns the number of nodes listed. */
static size_t named_once(const struct model_outline *outline, const int *paired, int *out)
{
    size_t count = 0, kept = 0;
    for (size_t i = 0; i < outline->header.count; i++)
        if (outline->nodes[i].name[0])
            out[count++] = (int)i;
    qsort_r(out, count, sizeof(*out), by_name, (void *)(uintptr_t)outline);
    for (size_t i = 0, end; i < count; i = end) {
        int node = out[i];
        for (end = i + 1; end < count && !strcmp(outline->nodes[node].name, outline->nodes[out[end]].name);)
            end++;
        if (end == i + 1 && paired[node] < 0)
            out[kept++] = node;
    }
    return kept;
}

static void take_named_once(struct node_pairing *p)
{
    p->old_count = named_once(p->old_outline, p->pairs->to_new, p->olds);
    p->new_count = named_once(p->new_outline, p->pairs->to_old, p->news);
}

/* --- pairing runs of candidates (unpaired nodes that compare equal) --- */

enum run_rule {
    RUN_SINGLE, /* pair only runs that consist of exactly one old and one new candidate */
    RUN_PLACED, /* within a run, pair candidates whose bounding boxes are at the same position */
    /* pair one old with one new candidate; in longer runs, pair candidates at the same position, then pair the rest in order if
     * equally many old and new ones remain */
    RUN_ORDERED
};

static void pair_placed(struct node_pairing *p, const int *olds, size_t old_count, const int *news, size_t new_count)
{
    for (size_t i = 0; i < old_count; i++)
        for (size_t k = 0; k < new_count && p->pairs->to_new[olds[i]] < 0; k++)
            if (p->pairs->to_old[news[k]] < 0 && in_same_place(&p->old_outline->nodes[olds[i]], &p->new_outline->nodes[news[k]]))
                pair(p, olds[i], news[k]);
}

static void pair_in_order(struct node_pairing *p, const int *olds, size_t old_count, const int *news, size_t new_count)
{
    size_t left = 0, k = 0;
    for (size_t i = 0; i < old_count; i++)
        left += p->pairs->to_new[olds[i]] < 0;
    for (size_t i = 0; i < new_count; i++)
        left -= p->pairs->to_old[news[i]] < 0;
    for (size_t i = 0; i < old_count && left == 0; i++) {
        if (p->pairs->to_new[olds[i]] >= 0)
            continue;
        while (p->pairs->to_old[news[k]] >= 0)
            k++;
        pair(p, olds[i], news[k]);
    }
}

static void pair_run(struct node_pairing *p, const int *olds, size_t old_count, const int *news, size_t new_count, enum run_rule rule)
{
    if (rule != RUN_PLACED && old_count == 1 && new_count == 1) {
        pair(p, olds[0], news[0]);
        return;
    }
    if (rule != RUN_SINGLE)
        pair_placed(p, olds, old_count, news, new_count);
    if (rule == RUN_ORDERED)
        pair_in_order(p, olds, old_count, news, new_count);
}

/* Walks through the sorted candidates (unpaired nodes) of both models in parallel, and pairs nodes within each run of nodes
 * that compare equal. rule: how the nodes of a run are paired. */
static void pair_runs(struct node_pairing *p, int (*compare)(const struct node_pairing *p, int old_node, int new_node), enum run_rule rule)
{
    for (size_t i = 0, k = 0; i < p->old_count && k < p->new_count;) {
        int order = compare(p, p->olds[i], p->news[k]);
        size_t old_end = i + 1, new_end = k + 1;
        if (order < 0) {
            i++;
            continue;
        }
        if (order > 0) {
            k++;
            continue;
        }
        while (old_end < p->old_count && compare(p, p->olds[old_end], p->news[k]) == 0)
            old_end++;
        while (new_end < p->new_count && compare(p, p->olds[i], p->news[new_end]) == 0)
            new_end++;
        pair_run(p, p->olds + i, old_end - i, p->news + k, new_end - k, rule);
        i = old_end;
        k = new_end;
    }
}

static int compare_names(const struct node_pairing *p, int old_node, int new_node)
{
    return strcmp(p->old_outline->nodes[old_node].name, p->new_outline->nodes[new_node].name);
}

static int compare_sizes(const struct node_pairing *p, int old_node, int new_node)
{
    size_t old_size = size_of(p->old_outline, old_node), new_size = size_of(p->new_outline, new_node);
    return (old_size > new_size) - (old_size < new_size);
}

static void pair_by_name(struct node_pairing *p, enum run_rule rule)
{
    qsort_r(p->olds, p->old_count, sizeof(*p->olds), by_name, (void *)(uintptr_t)p->old_outline);
    qsort_r(p->news, p->new_count, sizeof(*p->news), by_name, (void *)(uintptr_t)p->new_outline);
    pair_runs(p, compare_names, rule);
}

static size_t only_shown(const struct model_outline *outline, int *nodes, size_t count)
{
    size_t kept = 0;
    for (size_t i = 0; i < count; i++)
        if (outline->nodes[nodes[i]].all_triangles > 0)
            nodes[kept++] = nodes[i];
    return kept;
}

static void pair_by_size(struct node_pairing *p, enum run_rule rule)
{
    p->old_count = only_shown(p->old_outline, p->olds, p->old_count);
    p->new_count = only_shown(p->new_outline, p->news, p->new_count);
    qsort_r(p->olds, p->old_count, sizeof(*p->olds), by_size, (void *)(uintptr_t)p->old_outline);
    qsort_r(p->news, p->new_count, sizeof(*p->news), by_size, (void *)(uintptr_t)p->new_outline);
    pair_runs(p, compare_sizes, rule);
}

/* --- pairing methods ---------------------------------------------------------------------------------------------------------- */

static json_t *guids_of(const struct model_outline *outline)
{
    json_t *found = json_object();
    for (size_t i = 0; i < outline->header.count; i++) {
        const char *guid = model_outline_property(&outline->nodes[i], "GlobalId");
        if (guid) /* the map's values: index of the node with the GUID; -1: several nodes share the GUID */
            json_object_set_new_nocheck(found, guid, json_integer(json_object_get(found, guid) ? -1 : (json_int_t)i));
    }
    return found;
}

static void pair_by_guid(struct node_pairing *p)
{
    json_t *olds = guids_of(p->old_outline), *news = guids_of(p->new_outline), *value;
    const char *guid;
    json_object_foreach(olds, guid, value)
    {
        json_t *other = json_object_get(news, guid);
        if (other && json_integer_value(value) >= 0 && json_integer_value(other) >= 0)
            pair(p, (int)json_integer_value(value), (int)json_integer_value(other));
    }
    json_decref(olds);
    json_decref(news);
}

/* Pairs nodes by name, level by level from the roots, so that only children of paired parents are compared. */
static void pair_down_by_name(struct node_pairing *p)
{
    take_children(p, -1, -1);
    pair_by_name(p, RUN_ORDERED);
    for (size_t i = 0; i < p->old_outline->header.count; i++)
        if (p->pairs->to_new[i] >= 0) {
            take_children(p, (int)i, p->pairs->to_new[i]);
            pair_by_name(p, RUN_ORDERED);
        }
}

/* Pairs nodes by subtree size, level by level from the roots, because below a renamed parent the children often have new names too. */
static void pair_down_by_size(struct node_pairing *p)
{
    take_children(p, -1, -1);
    pair_by_size(p, RUN_PLACED);
    for (size_t i = 0; i < p->old_outline->header.count; i++) {
        int other = p->pairs->to_new[i];
        if (other < 0)
            continue;
        take_children(p, (int)i, other);
        pair_by_name(p, RUN_ORDERED);
        take_children(p, (int)i, other);
        pair_by_size(p, compare_names(p, (int)i, other) != 0 ? RUN_ORDERED : RUN_PLACED);
    }
}

void node_pairs_find(struct node_pairs *pairs, const struct model_outline *old_outline, const struct model_outline *new_outline)
{
    size_t olds = old_outline->header.count, news = new_outline->header.count;
    *pairs = (struct node_pairs){ mem_array(olds + 1, sizeof(*pairs->to_new)), mem_array(news + 1, sizeof(*pairs->to_old)) };
    memset(pairs->to_new, 0xff, olds * sizeof(*pairs->to_new));
    memset(pairs->to_old, 0xff, news * sizeof(*pairs->to_old));
    struct node_pairing p = { .old_outline = old_outline,
                              .new_outline = new_outline,
                              .pairs = pairs,
                              .olds = mem_array(olds + 1, sizeof(*p.olds)),
                              .news = mem_array(news + 1, sizeof(*p.news)) };
    pair_by_guid(&p);
    pair_down_by_name(&p);
    take_named_once(&p);
    pair_by_name(&p, RUN_SINGLE);
    pair_down_by_name(&p);
    pair_down_by_size(&p);
    mem_free(p.olds);
    mem_free(p.news);
}

void node_pairs_finish(struct node_pairs *pairs)
{
    mem_free(pairs->to_new);
    mem_free(pairs->to_old);
    *pairs = (struct node_pairs){ 0 };
}
