/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses the nodes of the models that become assets of the plant file: by level of the hierarchy, by patterns of their names or from a
 * list of names. Thread: any. */
#ifndef PREPROCESS_MATCH_EQUIPMENT_H
#define PREPROCESS_MATCH_EQUIPMENT_H
#include "base/text/text.h"
#include "preprocess/match/model_index.h"

/* Appends a plant-file line for each asset that `choices` select. A choice is "level=N" (roots are level 1), "@FILE" (names, one a line) or
 * a shell pattern of names. If both a node and its descendant match, only the upper one becomes an asset. Returns the number of assets, or
 * -1 with the reason in why. */
int equipment_choose(const struct model_index *site, const char *const *choices, int count, struct text *lines,
                     char why[MODEL_INDEX_WHY_BYTES]);

#endif
