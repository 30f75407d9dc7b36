/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast import --anew`: replaces the models of a plant folder together with a new plant file and tag list, which take nothing from the
 * existing files. Thread: one. */
#ifndef PREPROCESS_IMPORT_ANEW_H
#define PREPROCESS_IMPORT_ANEW_H
#include "preprocess/import/revision/revise.h"

/* Replaces models, plant.yaml and tags.csv together; revise_undo() reverts it. Replaced files that people may have written are kept as
 * NAME.1, NAME.2, ... An existing tag list stays unless `draft->anew` is set. Returns the exit status: 0, or 1 with the reason on standard
 * error, and then nothing was changed. */
int import_anew(const struct revise_params *params, const struct plant_draft *draft);

#endif
