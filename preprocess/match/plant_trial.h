/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads a plant file and a tag list that are not written yet, to see whether they are valid. Thread: one per plant. */
#ifndef PREPROCESS_MATCH_PLANT_TRIAL_H
#define PREPROCESS_MATCH_PLANT_TRIAL_H
#include "plant/plant.h"

/* Loads a plant from texts, which are put beside `plant`'s file for as long as that takes. tags NULL: the tag list as it is. Returns the
 * plant (plant_destroy), or NULL with the reasons on standard error, which begin with `program`. */
struct plant *plant_trial_load(const struct plant *plant, const char *text, const char *tags, const char *program);

#endif
