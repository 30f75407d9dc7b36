/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks that the files of a plant's replay sources contain the series that its tags replay. Reads only the beginning of each
   file. Call from one thread only. */
#ifndef VALUE_SERIES_CHECK_H
#define VALUE_SERIES_CHECK_H
#include "plant/plant.h"

/* Adds a finding to diag for each file that cannot be read and each series that is missing. */
void series_check(const struct plant *plant, struct diag *diag);

#endif
