/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Index of everything that a tag may be matched to: the plant's assets, the nodes of their models, and their names and
 * attributes. Call from one thread only while the index is built, any afterwards. */
#ifndef PREPROCESS_MATCH_MODEL_INDEX_H
#define PREPROCESS_MATCH_MODEL_INDEX_H
#include "plant/plant.h"
#include "preprocess/match/key_map.h"
#include "preprocess/match/model_tree.h"
#include "preprocess/match/name_tokens.h"

struct indexed_asset {
    struct name_tokens tokens; /* tokens of the asset's id */
    int number;                /* index of the token (run of letters or digits) with the equipment's number; -1: none */
    int model;                 /* index of the asset's model in model_index.models */
    /* index of the lowest common ancestor of the asset's nodes, or of its first node if there is none; -1: the asset is the whole model */
    int root;
};

struct model_index { /* zero-initialise */
    const struct plant *plant;
    struct model_tree *models;
    size_t model_count;
    struct indexed_asset *assets; /* data about each asset, in the order of the plant's assets */
    int **asset_of;               /* asset_of[model][node]: index of the (first) asset that the node belongs to; -1: none */
    struct key_map names;         /* assets by id, tag and node names; nodes by name */
    struct key_map folded;        /* assets by the folded key of their names, with 0 for O and 1 for I and L */
    struct key_map digits;        /* assets by the digits of their names (name_tokens_split()) */
    /* assets by the last part of their name, after a separator, if it has letters and digits */
    struct key_map endings;
    struct key_map numbers;    /* assets by the equipment's number */
    struct key_map attributes; /* nodes by attribute values that have letters and digits */
    struct key_map words;      /* assets by each word of their description, and of their name if it has no digits */
};

enum { MODEL_INDEX_WHY_BYTES = 300 };

/* Reads the models of a plant and builds the indexes. The plant must outlive the index. Returns false with the reason in why. */
bool model_index_read(struct model_index *site, const struct plant *plant, char why[MODEL_INDEX_WHY_BYTES]);
void model_index_finish(struct model_index *site);
/* Returns whether the CAD system generated the name ("BOX 1 of SUBSTRUCTURE ..."), so that no tag refers to it. */
bool model_index_is_made_up(const char *name);
/* Calls `each` with every word of a text, in upper case. Skips words of fewer than three letters, and common words that occur
 * in descriptions of any equipment. */
void model_index_each_word(const char *text, void (*each)(const char *word, void *data), void *data);

#endif
