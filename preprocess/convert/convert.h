/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Generates models, before they are prepared, by running the commands that the plant file gives for them (`convert`). Call from one
   thread only. */
#ifndef PREPROCESS_CONVERT_CONVERT_H
#define PREPROCESS_CONVERT_CONVERT_H
#include "base/text/diag.h"
#include "plant/plant.h"

/* Runs the command of each model that is missing or was modified, or whose input or command has changed since the last run.
 * Records the results in FOLDER/conversions.json and prints progress on `progress`. Returns false if a command fails; diag then
 * points to the command's line in the plant file, and the model keeps its previous content. */
bool convert_run(const struct plant *plant, const char *folder, FILE *progress, struct diag *diag);

#endif
