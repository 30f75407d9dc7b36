/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Imports series from a CSV file into history, such as data from before Plantcast was installed. Works while a daemon is recording. */
#ifndef HISTORY_IMPORT_H
#define HISTORY_IMPORT_H
#include "base/diag.h"
#include "base/log.h"
#include "plant/plant.h"

struct import_params {
    struct log *log;
    const struct plant *plant;
    const char *folder, *path;
    int64_t start_us; /* times are numbers that count from here; INT64_MIN: they are timestamps */
    int64_t unit_us;  /* of such numbers */
};

struct import_counts {
    long long samples, points; /* that were read; of these, recorded */
    int tags;
    int64_t from_us, to_us;
};

/* Imports a file in one of two forms. Long: columns Tag, Time, Value and perhaps Quality (0x80050000, Good, Uncertain, Bad) and Unit;
   without a unit, values are in the unit of the tag's row in the tag list (own_unit), as a device sends them. Wide: Time, then one column
   for each tag; a blank cell is no sample. The rows of each tag ascend in time. Findings go to diag; an error imports nothing.
   Returns false on errors, or if the folder cannot be written (logged). */
bool history_import(const struct import_params *params, struct diag *diag, struct import_counts *counts);

#endif
