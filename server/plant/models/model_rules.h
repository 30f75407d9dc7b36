/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Validates the types and references of a glTF document, because the glTF library accepts invalid ones, or drops them without
   an error. Call from any thread. */
#ifndef PLANT_MODELS_MODEL_RULES_H
#define PLANT_MODELS_MODEL_RULES_H
#include <jansson.h>

#include "plant/models/model_refusal.h"

/* Checks the version, the required extensions, the type and range of every property that is read later, and that every index
   refers to an existing object. Rewrites whole numbers such as 3.0 to 3. Returns false with the reason in why. */
bool model_rules_check(json_t *root, char why[MODEL_WHY_BYTES]);

/* Writes the name of an object for messages, such as "mesh 3 'pump', primitive 0"; without the primitive if `primitive` is negative. */
void model_rules_name(const json_t *root, const char *list, size_t number, int primitive, char *out, size_t bytes);

/* Returns whether this program implements the glTF extension of that name. */
bool model_rules_known(const char *name);
/* Returns whether a glTF extension affects only the look of a model (colours and materials), not its shape, so that it can be
   ignored. */
bool model_rules_look(const char *name);

#endif
