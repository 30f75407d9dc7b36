/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The types and references of a glTF document: what the glTF library takes as it comes, or drops without a word. */
#ifndef PREPROCESS_MODEL_RULES_H
#define PREPROCESS_MODEL_RULES_H
#include <jansson.h>

#include "preprocess/model/refusal.h"

/* Version, required extensions, the type and range of every property that is read later, and that every index names something that is
   there. Whole numbers that are written as 3.0 become 3. */
bool model_rules_check(json_t *root, char why[MODEL_WHY_BYTES]);

/* "mesh 3 'pump', primitive 0": for messages. primitive < 0: without. */
void model_rules_name(const json_t *root, const char *list, size_t number, int primitive, char *out, size_t bytes);

#endif
