/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds the indexes that map names, numbers and words to assets and nodes. */
#include "preprocess/match/model_index.h"

#include <stdio.h>
#include <string.h>

#include "base/mem.h"

enum { LONGEST_VALUE = 60 };

bool model_index_is_made_up(const char *name)
{
    return !*name || *name == '=' || strstr(name, " of ") != NULL;
}

void model_index_each_word(const char *text, void (*each)(const char *word, void *data), void *data)
{
    static const char *const common[] = { "THE", "AND", "FOR", "FROM", "WITH", "UNSET", "UNIT", "LINE", "TAG", "NULL", "NONE" };
    struct name_tokens tokens;
    name_tokens_read(&tokens, text);
    for (int i = 0; i < tokens.count; i++) {
        bool skip = tokens.at[i].digits || strlen(tokens.at[i].text) < 3;
        for (size_t k = 0; k < sizeof(common) / sizeof(*common) && !skip; k++)
            skip = !strcmp(common[k], tokens.at[i].text);
        if (!skip)
            each(tokens.at[i].text, data);
    }
}

/* --- names ------------------------------------------------------------------------------------------------------------------ */

/* Returns the index of the token (run of letters or digits) that is probably the equipment's number: the longest run of at
 * least two digits, the last one if several are equally long; -1: none. */
static int find_number(const struct name_tokens *tokens)
{
    int best = -1;
    for (int i = 0; i < tokens->count; i++)
        if (tokens->at[i].digits && tokens->at[i].raw_length >= 2 && (best < 0 || tokens->at[i].raw_length >= tokens->at[best].raw_length))
            best = i;
    return best;
}

static void add_endings(struct model_index *site, const struct name_tokens *tokens, int asset)
{
    char key[NAME_KEY_BYTES];
    for (int i = 1; i + 1 < tokens->count; i++)
        if (name_tokens_have(tokens, i, tokens->count, true) && name_tokens_have(tokens, i, tokens->count, false)) {
            name_tokens_key(tokens, i, tokens->count, key);
            if (strlen(key) >= 4)
                key_map_add(&site->endings, key, asset, -1);
        }
}

struct word_target {
    struct model_index *site;
    int asset;
};

static void add_word(const char *word, void *data)
{
    struct word_target *target = data;
    key_map_add(&target->site->words, word, target->asset, -1);
}

static void add_asset_name(struct model_index *site, int asset, const char *name)
{
    struct name_tokens tokens;
    char key[NAME_KEY_BYTES], letters[NAME_KEY_BYTES];
    name_tokens_read(&tokens, name);
    if (tokens.count == 0)
        return;
    name_tokens_key(&tokens, 0, tokens.count, key);
    key_map_add(&site->names, key, asset, -1);
    if (name_tokens_have(&tokens, 0, tokens.count, true)) {
        name_tokens_folded(&tokens, 0, tokens.count, key);
        key_map_add(&site->folded, key, asset, -1);
        name_tokens_split(&tokens, 0, tokens.count, key, letters);
        key_map_add(&site->digits, key, asset, -1);
        add_endings(site, &tokens, asset);
    } else {
        model_index_each_word(name, add_word, &(struct word_target){ site, asset });
    }
    int number = find_number(&tokens);
    if (number >= 0)
        key_map_add(&site->numbers, tokens.at[number].text, asset, -1);
}

static void add_asset_names(struct model_index *site, int asset)
{
    const struct plant_asset *of = &site->plant->assets[asset];
    struct indexed_asset *own = &site->assets[asset];
    name_tokens_read(&own->tokens, of->id);
    own->number = find_number(&own->tokens);
    add_asset_name(site, asset, of->id);
    if (strcmp(of->tag, of->id) != 0)
        add_asset_name(site, asset, of->tag);
    model_index_each_word(of->description, add_word, &(struct word_target){ site, asset });
}

/* --- nodes ------------------------------------------------------------------------------------------------------------------ */

static void add_node_names(struct model_index *site, int model, int node)
{
    const struct model_tree *tree = &site->models[model];
    int asset = site->asset_of[model][node];
    bool itself = site->assets[asset].root == node;
    struct name_tokens tokens;
    char key[NAME_KEY_BYTES];
    if (!itself && !model_index_is_made_up(tree->nodes[node].name)) {
        name_tokens_read(&tokens, tree->nodes[node].name);
        name_tokens_key(&tokens, 0, tokens.count, key);
        if (tokens.count >= 2 && name_tokens_have(&tokens, 0, tokens.count, true) && name_tokens_have(&tokens, 0, tokens.count, false))
            key_map_add(&site->names, key, asset, node);
    }
    const struct tree_node *more = &tree->more[node];
    for (size_t i = 0; i < more->attribute_count; i++) {
        const char *value = more->attributes[i].value;
        if (strlen(value) > LONGEST_VALUE || !strcmp(more->attributes[i].name, "Owner"))
            continue;
        name_tokens_read(&tokens, value);
        if (tokens.count < 2 || !name_tokens_have(&tokens, 0, tokens.count, true) || !name_tokens_have(&tokens, 0, tokens.count, false))
            continue;
        name_tokens_key(&tokens, 0, tokens.count, key);
        key_map_add(&site->attributes, key, asset, itself ? -1 : node);
    }
}

/* Marks in asset_of the model's nodes that belong to the asset, and finds its root node. Returns false with the reason in why. */
static bool take_nodes(struct model_index *site, int asset, char why[MODEL_INDEX_WHY_BYTES])
{
    const struct plant_asset *of = &site->plant->assets[asset];
    struct indexed_asset *own = &site->assets[asset];
    const struct model_tree *tree = &site->models[own->model];
    char reason[200];
    size_t from = 0, to = tree->count, named = 0;
    own->root = -1;
    for (size_t i = 0; i < tree->count && of->nodes; i++)
        if (!strcmp(tree->nodes[i].name, of->nodes)) {
            named++;
            from = i;
            to = tree->nodes[i].end;
        }
    if (of->nodes && named != 1) { /* the asset is not selected by a single plain node name: match its node patterns */
        bool *taken = mem_array(tree->count, sizeof(*taken));
        bool good = nodes_take(of->nodes, tree->nodes, tree->count, taken, reason, sizeof(reason));
        for (size_t i = 0; i < tree->count && good; i++)
            if (taken[i]) {
                own->root = own->root < 0 ? (int)i : own->root;
                if (site->asset_of[own->model][i] < 0)
                    site->asset_of[own->model][i] = asset;
            }
        mem_free(taken);
        if (!good)
            snprintf(why, MODEL_INDEX_WHY_BYTES, "asset '%.60s': %.200s", of->id, reason);
        return good;
    }
    if (of->nodes)
        own->root = (int)from;
    for (size_t i = from; i < to; i++)
        if (site->asset_of[own->model][i] < 0)
            site->asset_of[own->model][i] = asset;
    return true;
}

static bool read_model(struct model_index *site, int asset, char why[MODEL_INDEX_WHY_BYTES])
{
    const char *path = site->plant->assets[asset].model;
    char reason[TREE_WHY_BYTES];
    size_t m = 0;
    while (m < site->model_count && strcmp(site->models[m].path, path) != 0)
        m++;
    site->assets[asset].model = (int)m;
    if (m < site->model_count)
        return true;
    if (!model_tree_read(&site->models[m], path, reason)) {
        snprintf(why, MODEL_INDEX_WHY_BYTES, "%.90s: %.200s", path, reason);
        return false;
    }
    site->model_count++;
    site->asset_of[m] = mem_array(site->models[m].count, sizeof(int));
    memset(site->asset_of[m], 0xff, site->models[m].count * sizeof(int));
    return true;
}

bool model_index_read(struct model_index *site, const struct plant *plant, char why[MODEL_INDEX_WHY_BYTES])
{
    bool good = true;
    *site = (struct model_index){ .plant = plant,
                                  .models = mem_array(plant->asset_count, sizeof(*site->models)),
                                  .assets = mem_array(plant->asset_count, sizeof(*site->assets)),
                                  .asset_of = mem_array(plant->asset_count, sizeof(*site->asset_of)) };
    for (size_t a = 0; a < plant->asset_count && good; a++)
        good = read_model(site, (int)a, why) && take_nodes(site, (int)a, why);
    for (size_t a = 0; a < plant->asset_count && good; a++)
        add_asset_names(site, (int)a);
    for (size_t m = 0; m < site->model_count && good; m++)
        for (size_t i = 0; i < site->models[m].count; i++)
            if (site->asset_of[m][i] >= 0)
                add_node_names(site, (int)m, (int)i);
    if (!good)
        model_index_finish(site);
    return good;
}

void model_index_finish(struct model_index *site)
{
    for (size_t m = 0; m < site->model_count; m++) {
        model_tree_finish(&site->models[m]);
        mem_free(site->asset_of[m]);
    }
    struct key_map *const maps[] = { &site->names,   &site->folded,     &site->digits, &site->endings,
                                     &site->numbers, &site->attributes, &site->words };
    for (size_t i = 0; i < sizeof(maps) / sizeof(*maps); i++)
        key_map_finish(maps[i]);
    mem_free(site->models);
    mem_free(site->assets);
    mem_free(site->asset_of);
    *site = (struct model_index){ 0 };
}
