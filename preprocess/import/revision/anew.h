/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast import --anew`: replaces a plant folder's models together with its plant file and tag list, without taking
 * anything over from the existing files. Call from one thread only. */
#ifndef PREPROCESS_IMPORT_ANEW_H
#define PREPROCESS_IMPORT_ANEW_H
#include "preprocess/import/revision/revise.h"

/* Replaces models, plant.yaml and tags.csv together; revise_undo() reverts this. Replaced files that users may have written are
 * kept as NAME.1, NAME.2, ... An existing tag list stays unless `draft->anew` is set. Returns the exit status: 0, or 1 with the
 * reason on standard error and nothing changed. */
int import_anew(const struct revise_params *params, const struct plant_draft *draft);

#endif
