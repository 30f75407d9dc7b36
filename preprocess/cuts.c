/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Two lists in a file. */
#include "preprocess/cuts.h"

#include <string.h>

#include "base/kept.h"
#include "base/mem.h"
#include "base/pack.h"

#define MAGIC "PLCCUTS1"

void cuts_read(struct cuts *cuts, const char *folder)
{
    struct kept kept;
    char *path = mem_printf("%s/cuts", folder);
    *cuts = (struct cuts){ 0 };
    if (kept_open(&kept, path, MAGIC, 0)) {
        struct unpack from = { kept.bytes, kept.count, false };
        cuts->at = unpack_array(&from, &cuts->count, sizeof(*cuts->at));
        cuts->nodes = unpack_array(&from, &cuts->node_count, sizeof(*cuts->nodes));
        cuts->capacity = cuts->count;
        cuts->node_capacity = cuts->node_count;
        if (from.bad)
            cuts_finish(cuts);
        kept_close(&kept);
    }
    mem_free(path);
}

int cuts_write(const struct cuts *cuts, const char *folder)
{
    struct text file = { 0 };
    char *path = mem_printf("%s/cuts", folder);
    pack_array(&file, cuts->at, cuts->count, sizeof(*cuts->at));
    pack_array(&file, cuts->nodes, cuts->node_count, sizeof(*cuts->nodes));
    int status = kept_write(path, MAGIC, 0, file.at, file.length);
    text_finish(&file);
    mem_free(path);
    return status;
}

void cuts_finish(struct cuts *cuts)
{
    mem_free(cuts->at);
    mem_free(cuts->nodes);
    *cuts = (struct cuts){ 0 };
}

bool cuts_same(const struct cuts *a, const struct cuts *b)
{
    return a->count == b->count && a->node_count == b->node_count &&
           (!a->count || memcmp(a->at, b->at, a->count * sizeof(*a->at)) == 0) &&
           (!a->node_count || memcmp(a->nodes, b->nodes, a->node_count * sizeof(*a->nodes)) == 0);
}

bool cuts_find(const struct cuts *cuts, uint64_t recipe, uint64_t *geometry)
{
    for (size_t i = 0; i < cuts->count; i++)
        if (cuts->at[i].recipe == recipe) {
            *geometry = cuts->at[i].geometry;
            return true;
        }
    return false;
}

bool cuts_find_node(const struct cuts *cuts, uint64_t recipe, uint64_t node_hash, double place_m[3])
{
    for (size_t i = 0; i < cuts->node_count; i++)
        if (cuts->nodes[i].recipe == recipe && cuts->nodes[i].node_hash == node_hash) {
            memcpy(place_m, cuts->nodes[i].place_m, sizeof(cuts->nodes[i].place_m));
            return true;
        }
    return false;
}

void cuts_add(struct cuts *cuts, uint64_t recipe, uint64_t geometry)
{
    if (cuts_find(cuts, recipe, &(uint64_t){ 0 }))
        return;
    mem_grow(&cuts->at, &cuts->capacity, cuts->count + 1, sizeof(*cuts->at));
    cuts->at[cuts->count++] = (struct cut){ recipe, geometry };
}

void cuts_add_node(struct cuts *cuts, uint64_t recipe, uint64_t node_hash, const double place_m[3])
{
    double known_m[3];
    if (cuts_find_node(cuts, recipe, node_hash, known_m))
        return;
    mem_grow(&cuts->nodes, &cuts->node_capacity, cuts->node_count + 1, sizeof(*cuts->nodes));
    struct cut_node *node = &cuts->nodes[cuts->node_count++];
    *node = (struct cut_node){ .recipe = recipe, .node_hash = node_hash };
    memcpy(node->place_m, place_m, sizeof(node->place_m));
}
