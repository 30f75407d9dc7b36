/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What tags may be matched to: the plant's assets, the nodes of their models, and all names and attributes of these. Thread: one while it
 * is made, then any. */
#ifndef PREPROCESS_MATCH_MODEL_INDEX_H
#define PREPROCESS_MATCH_MODEL_INDEX_H
#include "plant/plant.h"
#include "preprocess/match/key_map.h"
#include "preprocess/match/model_tree.h"
#include "preprocess/match/name_tokens.h"

struct indexed_asset {
    struct name_tokens tokens; /* of its id */
    int number;                /* of tokens: the equipment's number; -1: none */
    int model;                 /* in site.models */
    int root;                  /* the node above all of its nodes, or the first of them; -1: the whole model */
};

struct model_index { /* zero-initialise */
    const struct plant *plant;
    struct model_tree *models;
    size_t model_count;
    struct indexed_asset *assets; /* by the plant's */
    int **asset_of;               /* by model and node; -1: none. A node of several assets is of the first */
    struct key_map names;         /* assets by id, tag, and the names of their nodes; nodes by name */
    struct key_map folded;        /* assets only, by name_tokens_folded() */
    struct key_map digits;        /* assets only, by their digits */
    struct key_map endings;       /* assets only, by the end of their name, from a sign on, if that has letters and digits */
    struct key_map numbers;       /* assets only, by the equipment's number */
    struct key_map attributes;    /* nodes by the value of an attribute that has letters and digits */
    struct key_map words;         /* assets only, by each word of their description and of names without digits */
};

enum { MODEL_INDEX_WHY_BYTES = 300 };

/* Reads the models of a plant, which must outlive the site. Returns false with the reason in `why`. */
bool model_index_read(struct model_index *site, const struct plant *plant, char why[MODEL_INDEX_WHY_BYTES]);
void model_index_finish(struct model_index *site);
/* Returns whether a name is one that the CAD system made up ("BOX 1 of SUBSTRUCTURE ..."), by which nobody calls anything. */
bool model_index_is_made_up(const char *name);
/* Calls `each` for every word of a text: at least three letters, in upper case, none that every description has. */
void model_index_each_word(const char *text, void (*each)(const char *word, void *data), void *data);

#endif
