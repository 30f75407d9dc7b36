/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The first plant.yaml of an imported plant: the models, with an asset for each element that people would call by its name. */
#ifndef PREPROCESS_IMPORT_PLANT_DRAFT_H
#define PREPROCESS_IMPORT_PLANT_DRAFT_H
#include "preprocess/import/model_outline.h"

struct plant_draft_model {
    char *file;             /* its name in the folder */
    const char *units, *up; /* what its assets say of them; NULL: nothing */
    int item_level;         /* how deep its pieces of equipment are, if its properties do not say; 0: where the tree branches first */
    struct model_outline outline;
};

struct plant_draft {
    const char *name, *folder;
    const struct plant_draft_model *models;
    size_t count;
};

/* Appends a line for each asset that the model is to have, of those whose nodes `wanted` marks (NULL: all), to a list of assets. ids are
 * the keys of an object; new ones are added to it. Returns how many there are. */
size_t plant_draft_add_assets(const struct plant_draft_model *model, const bool *wanted, json_t *ids, struct text *out);

/* Writes FOLDER/plant.yaml, unless it is there: then a person may have changed it, and it stays. Returns 0 or -errno. */
int plant_draft_write(const struct plant_draft *draft);

#endif
