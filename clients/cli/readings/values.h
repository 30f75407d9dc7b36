/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads tag values with their quality from a CSV file with rows `tag,value[,quality]`. The header line is optional; with a header there may
   be a column `unit`. Quality is good (default), uncertain or bad; an empty value is bad. Values are in the unit of the tag's row in the
   tag list (own_unit) unless the column `unit` names another. */
#ifndef CLI_READINGS_VALUES_H
#define CLI_READINGS_VALUES_H
#include <stdbool.h>

#include "base/text/diag.h"
#include "plant/plant.h"
#include "value/snapshot.h"

/* Sets the snapshot's readings of the tags in the file. Returns false if there are errors; adds every error to diag. */
bool values_read(const struct plant *plant, const char *path, struct snapshot *snapshot, struct diag *diag);

#endif
