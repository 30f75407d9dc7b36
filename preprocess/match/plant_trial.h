/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads a plant from texts not yet written, to check that they are valid. Use each plant in one thread only. */
#ifndef PREPROCESS_MATCH_PLANT_TRIAL_H
#define PREPROCESS_MATCH_PLANT_TRIAL_H
#include "plant/plant.h"

/* Loads a plant from texts, after writing them to temporary files in the folder of `plant`'s file. tags NULL: uses the current
 * tag list. Returns the plant (free it with plant_destroy()), or NULL after printing the reasons on standard error, each
 * prefixed by `program`. */
struct plant *plant_trial_load(const struct plant *plant, const char *text, const char *tags, const char *program);

#endif
