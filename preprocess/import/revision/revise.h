/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Imports new versions of models into a folder that already contains a plant. Thread: one. */
#ifndef PREPROCESS_IMPORT_REVISE_H
#define PREPROCESS_IMPORT_REVISE_H
#include "preprocess/import/plant_draft.h"

struct revise_params {
    const char *folder;                     /* plant folder; contains plant.yaml */
    const char *work;                       /* temporary folder inside the plant folder; N.glb in it is the converted model N */
    const struct plant_draft_model *models; /* array of the converted models with their outlines */
    size_t count;
    bool dry_run; /* only print what would change */
};

/* Replaces models, plant.yaml and tags.csv together. Prints a review of the changes and writes it to review.csv. Returns the exit status:
 * 0, or 1 with the reasons on standard error, and then nothing was changed. */
int revise(const struct revise_params *params);

/* Undoes the last revision: restores all files that it replaced. forced: also restores files that have changed since the revision. lent:
 * descriptor of the folder lock that the parent process holds (plant_folder.h); 0: none. Returns the exit status. */
int revise_undo(const char *folder, bool forced, int lent);

#endif
