/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes the first plant.yaml of an imported plant: its models, with an asset for each piece of equipment. */
#ifndef PREPROCESS_IMPORT_PLANT_DRAFT_H
#define PREPROCESS_IMPORT_PLANT_DRAFT_H
#include "preprocess/import/model_outline.h"

struct plant_draft_model {
    char *file;             /* file name of the model in the plant folder */
    const char *units, *up; /* values of `units` and `up` for the model's assets in plant.yaml; NULL: the key is omitted */
    /* tree level whose nodes become assets if no node has a type or an IFC class; 0: the topmost level with at least two nodes
     * that have geometry */
    int item_level;
    struct model_outline outline;
};

struct plant_draft {
    const char *name, *folder;
    const struct plant_draft_model *models;
    size_t count;
    bool anew; /* true: replace an existing plant file and tag list; false: leave them */
};

/* Appends a plant file line for each asset of the model whose node is marked in `wanted` (NULL: all assets). ids: a JSON object
 * whose keys are the asset ids in use; new ids are added as keys. Returns the number of assets. */
size_t plant_draft_add_assets(const struct plant_draft_model *model, const bool *wanted, json_t *ids, struct text *out);

/* Returns the text of the new plant file, which the caller frees with mem_free. *assets receives the number of its assets. */
char *plant_draft_text(const struct plant_draft *draft, size_t *assets);
/* Returns the text of a tag list without tags (static, not to be freed). */
const char *plant_draft_tags(void);
/* Writes FOLDER/plant.yaml and FOLDER/tags.csv. Keeps existing files, since a user may have edited them, unless `draft->anew`
 * is set. Returns 0, or -errno after printing the error. */
int plant_draft_write(const struct plant_draft *draft);
/* Returns whether a plant file is still exactly as plant_draft_begin() wrote it (no user has edited it). */
bool plant_draft_is_begun(const char *path);
/* Writes a starter plant, a model of a person 1.8 m tall, into a folder without plant.yaml. Does nothing if plant.yaml exists.
 * Returns 0, or a non-zero status after printing the error. */
int plant_draft_begin(const char *folder);

#endif
