/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Generates models by the commands that a plant file states for them (`convert`), before the models are prepared. Thread: one. */
#ifndef PREPROCESS_CONVERT_CONVERT_H
#define PREPROCESS_CONVERT_CONVERT_H
#include "base/text/diag.h"
#include "plant/plant.h"

/* Runs the command of each model that is missing or was modified, or whose input or command has changed since the last run. Records the
 * results in FOLDER/conversions.json and prints progress on `progress`. Returns false if a command fails; diag then names the command's
 * line of the plant file, and the model keeps its previous content. */
bool convert_run(const struct plant *plant, const char *folder, FILE *progress, struct diag *diag);

#endif
