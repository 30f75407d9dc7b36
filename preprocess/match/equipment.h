/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which nodes of the models are equipment, where the plant file's assets are to be chosen anew: a level of the hierarchy, patterns of
 * names, or a list. Thread: any. */
#ifndef PREPROCESS_MATCH_EQUIPMENT_H
#define PREPROCESS_MATCH_EQUIPMENT_H
#include "base/text/text.h"
#include "preprocess/match/model_index.h"

/* Appends a line for each asset that `choices` take: "level=N" (the roots are level 1), "@FILE" (names, one a line) or a pattern of names
 * as a shell has it. Of nested ones the upper is taken. Returns how many there are, or -1 with the reason. */
int equipment_choose(const struct model_index *site, const char *const *choices, int count, struct text *lines,
                     char why[MODEL_INDEX_WHY_BYTES]);

#endif
