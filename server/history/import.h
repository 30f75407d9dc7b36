/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Series out of a CSV file into history: what happened before Plantcast was there. Works beside a daemon that records. */
#ifndef HISTORY_IMPORT_H
#define HISTORY_IMPORT_H
#include "base/diag.h"
#include "base/log.h"
#include "plant/plant.h"

struct import_params {
    struct log *log;
    const struct plant *plant;
    const char *folder, *path;
    int64_t start_us; /* times are numbers that count from here; INT64_MIN: they are instants (timestamp_parse, timestamp_parse_local) */
    int64_t unit_us;  /* of such numbers */
};

struct import_counts {
    long long samples, points; /* read, and kept of them */
    int tags;
    int64_t from_us, to_us;
};

/* Long: columns Tag, Time, Value and perhaps Quality (0x80050000, Good, Uncertain, Bad) and Unit; where it says none, values are in the
   unit of the tag's row (own_unit), as a device gives them. Wide: Time, then one column for each tag; a
   blank cell is no sample. Each tag's rows ascend in time. Every finding goes to diag; nothing is imported if one is an error.
   False: findings, or the folder cannot be written (logged). */
bool history_import(const struct import_params *params, struct diag *diag, struct import_counts *counts);

#endif
