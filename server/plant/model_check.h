/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What can be said of a plant's models without reading their vertices: are they models, are the nodes there that the plant names, how large
   are the assets, and do the sensors lie on them? Thread: one. */
#ifndef PLANT_MODEL_CHECK_H
#define PLANT_MODEL_CHECK_H
#include <stdio.h>

#include "plant/plant.h"

/* Findings go to diag, and a line with its size for each asset to out (NULL: none). */
void models_check(const struct plant *plant, struct diag *diag, FILE *out);

#endif
