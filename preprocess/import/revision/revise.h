/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Brings converted models into a folder that has a plant already. Thread: one. */
#ifndef PREPROCESS_IMPORT_REVISE_H
#define PREPROCESS_IMPORT_REVISE_H
#include "preprocess/import/plant_draft.h"

struct revise_params {
    const char *folder;                     /* has plant.yaml */
    const char *work;                       /* a folder inside it; N.glb is model N */
    const struct plant_draft_model *models; /* with outlines */
    size_t count;
    bool dry_run; /* only says what it would do */
};

/* Replaces models, plant.yaml and tags.csv together, and prints a review of what that changes, which also goes to review.csv. Returns the
 * exit status: 0, or 1 with the reasons on standard error, and then nothing was changed. */
int revise(const struct revise_params *params);

/* Puts everything back as it was before the last revision. forced: files that have changed since, too. lent: plant_folder.h. Returns the
 * exit status. */
int revise_undo(const char *folder, bool forced, int lent);

#endif
