/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Do the files of a plant's replays hold what its tags want? Heads are read, not whole files. Thread: one. */
#ifndef VALUE_SERIES_CHECK_H
#define VALUE_SERIES_CHECK_H
#include "plant/plant.h"

void series_check(const struct plant *plant, struct diag *diag);

#endif
