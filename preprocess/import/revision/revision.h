/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plans how a new export of a plant's models changes its plant file and tag list: assets follow their nodes, sensors their
 * equipment; assets are removed with their equipment, and added for new equipment. Also writes a review of these changes for
 * users. Call from one thread only. */
#ifndef PREPROCESS_IMPORT_REVISION_H
#define PREPROCESS_IMPORT_REVISION_H
#include "plant/plant.h"
#include "preprocess/import/plant_draft.h"
#include "preprocess/import/revision/asset_edit.h"
#include "plant/models/model_refusal.h"

struct revision_model {
    /* paths of the old and the new model file; before NULL: the plant has no model with this name yet */
    char *before, *after;
    const struct plant_draft_model *draft; /* describes the new model */
};

enum revision_kind { REVISION_ASSET, REVISION_NODE, REVISION_TAG };
struct revision_row {
    enum revision_kind kind;
    /* kind of change (static string): "added", "removed", "renamed", "moved", "changed", "node lost", "place lost",
     * "equipment lost" */
    const char *change;
    char *name, *detail;
};

struct revision {                 /* zero-initialise */
    char *plant_text, *tags_text; /* new texts of plant.yaml and the tag list; NULL: no change */
    struct revision_row *rows;    /* rows of the review, in the order they are printed */
    const char **lost;            /* tags whose equipment was removed; the strings belong to the plant */
    size_t row_count, row_room, lost_count, lost_room;
};

struct revision_input {
    const struct plant *plant;
    const char *plant_text, *tags_text; /* current texts of plant.yaml and the tag list; tags_text NULL: the plant has no tag list */
    const struct revision_model *models;
    size_t model_count;
};

/* Compares the models and composes the new texts and the review. Returns false with the reason in why. In either case, call
 * revision_finish(). */
bool revision_plan(struct revision *revision, const struct revision_input *input, char why[MODEL_WHY_BYTES]);
void revision_finish(struct revision *revision);

#endif
