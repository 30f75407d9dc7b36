/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Imports new versions of models into a folder that already contains a plant. Call from one thread only. */
#ifndef PREPROCESS_IMPORT_REVISE_H
#define PREPROCESS_IMPORT_REVISE_H
#include "preprocess/import/plant_draft.h"

struct revise_params {
    const char *folder;                     /* plant folder; contains plant.yaml */
    const char *work;                       /* temporary folder inside the plant folder; its file N.glb is converted model N */
    const struct plant_draft_model *models; /* the converted models and their outlines */
    size_t count;
    bool dry_run; /* only print the planned changes */
};

/* Replaces models, plant.yaml and tags.csv together. Prints a review of the changes and writes it to review.csv. Returns the
 * exit status: 0, or 1 with the reasons on standard error and nothing changed. */
int revise(const struct revise_params *params);

/* Undoes the last revision by restoring all files that it replaced. forced: also restores files that have changed since. lent:
 * descriptor of the folder lock held by the parent process (plant_folder.h); 0: none. Returns the exit status. */
int revise_undo(const char *folder, bool forced, int lent);

#endif
