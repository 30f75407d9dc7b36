/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Readings from a CSV file: `tag,value[,quality]`, with or without that header, which may have a column `unit` too; quality is good
   (default), uncertain or bad; an empty value is bad. Values are in the unit of the tag's row (own_unit) unless `unit` says another. */
#ifndef CLI_READINGS_VALUES_H
#define CLI_READINGS_VALUES_H
#include <stdbool.h>

#include "base/text/diag.h"
#include "plant/plant.h"
#include "value/snapshot.h"

/* Reads the file and sets the readings of the tags that it names in the snapshot. Returns false with every error in diag. */
bool values_read(const struct plant *plant, const char *path, struct snapshot *snapshot, struct diag *diag);

#endif
