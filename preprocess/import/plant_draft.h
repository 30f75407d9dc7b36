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
    bool anew; /* plant file and tag list that are there count for nothing */
};

/* Appends a line for each asset that the model is to have, of those whose nodes `wanted` marks (NULL: all), to a list of assets. ids are
 * the keys of an object; new ones are added to it. Returns how many there are. */
size_t plant_draft_add_assets(const struct plant_draft_model *model, const bool *wanted, json_t *ids, struct text *out);

/* Returns the text of its plant file, and how many assets that has; mem_free. */
char *plant_draft_text(const struct plant_draft *draft, size_t *assets);
/* Returns the text of a tag list without tags; static. */
const char *plant_draft_tags(void);
/* Writes FOLDER/plant.yaml and FOLDER/tags.csv. One that is there may have been changed by a person, and stays. Returns 0, or -errno,
 * already printed. */
int plant_draft_write(const struct plant_draft *draft);
/* Returns whether a plant file is as plant_draft_begin() wrote it. */
bool plant_draft_is_begun(const char *path);
/* Writes the plant of a folder that has none yet: a person, 1.8 m tall. Does nothing where there is a plant.yaml. Returns likewise. */
int plant_draft_begin(const char *folder);

#endif
