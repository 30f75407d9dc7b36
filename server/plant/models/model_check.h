/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks a plant's models without reading their vertices: whether the files are models and have the nodes that the plant file
   names, how large the assets are, and whether the sensors are near them. Call from one thread only. */
#ifndef PLANT_MODELS_MODEL_CHECK_H
#define PLANT_MODELS_MODEL_CHECK_H
#include <stdio.h>

#include "plant/plant.h"

/* Adds errors and warnings to diag, and prints a line with the size of each asset to `out` (NULL: no lines). Returns false, with an error
   in diag, if the plant has more triangles than a machine with memory_bytes of memory (0: this machine) can serve. */
bool models_check(const struct plant *plant, size_t memory_bytes, struct diag *diag, FILE *out);

#endif
