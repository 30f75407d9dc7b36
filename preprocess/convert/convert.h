/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes the models that a plant file says how to make (`convert`), before they are prepared. Thread: one. */
#ifndef PREPROCESS_CONVERT_CONVERT_H
#define PREPROCESS_CONVERT_CONVERT_H
#include "base/text/diag.h"
#include "plant/plant.h"

/* Runs the command of each model whose input or command has changed since it was made, or that is not there or was changed itself; what was
 * made is recorded in FOLDER/conversions.json. Says on `progress` what it makes. Returns false if one fails, with its line in diag: that
 * model stays as it was. */
bool convert_run(const struct plant *plant, const char *folder, FILE *progress, struct diag *diag);

#endif
