/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses the model nodes that become assets of the plant file: by level of the hierarchy, by name patterns or from a list of
 * names. Call from any thread. */
#ifndef PREPROCESS_MATCH_EQUIPMENT_H
#define PREPROCESS_MATCH_EQUIPMENT_H
#include "base/text/text.h"
#include "preprocess/match/model_index.h"

/* Appends a plant-file line for each asset selected by `choices`. A choice is "level=N" (roots are level 1), "@FILE" (names,
 * one per line) or a shell pattern for names. If a node and its descendant both match, only the upper one becomes an asset.
 * Returns the number of assets, or -1 with the reason in why. */
int equipment_choose(const struct model_index *site, const char *const *choices, int count, struct text *lines,
                     char why[MODEL_INDEX_WHY_BYTES]);

#endif
