/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Imports series from a CSV file into history, such as data from before Plantcast was installed. Works while a daemon is recording. */
#ifndef HISTORY_IMPORT_H
#define HISTORY_IMPORT_H
#include "base/log/log.h"
#include "base/text/charset.h"
#include "base/text/diag.h"
#include "plant/plant.h"

struct import_params {
    struct log *log;
    const struct plant *plant;
    const char *folder, *path;
    const char *encoding; /* of the file; NULL: found from its bytes */
    int64_t start_us; /* times are numbers that count from here; INT64_MIN: they are timestamps */
    int64_t unit_us;  /* of such numbers */
    int64_t longest_gap_us; /* a longer time between two samples of a tag has no data; 0: derived from each series */
};

struct import_counts {
    long long samples, points; /* that were read; of these, recorded */
    long long bad, duplicates, gaps; /* samples without a usable value; replaced by a later row of the same time; times without data */
    int tags;
    struct charset_choice encoding;
    bool exported;            /* the columns are those of `plantcast history export` */
    int64_t from_us, to_us;
    int64_t longest_us[2]; /* the longest gap that counts as data: the smallest and the largest of all series */
};

/* Imports a file in one of two forms. Long: columns Tag, Time, Value and perhaps Quality (0x80050000, Good, Uncertain, Bad) and Unit;
   without a unit, values are in the unit of the tag's row in the tag list (own_unit), as a device sends them. Wide: Time, then one column
   for each tag. A blank cell and a state word (value/state_word.h) are Bad samples. The rows of each tag ascend in time; of rows with equal
   times the last one counts. After the last sample before a gap, and after the end of a series that nothing follows, a point without a
   value (Bad_NoCommunication) is recorded. The longest time that is no gap is longest_gap_us; else the tag's Stale s, if its row states it
   and the series is not slower than that; else ten times the median spacing of the series. A series of two samples takes the median over
   all other series; if there are none, the tag's Stale s or twice override_s. In an exported file, where lines replace
   samples, twice override_s is never a gap, and for a tag that is never stale nothing is. Findings go to diag; an error imports nothing.
   Returns false on errors, or if the folder cannot be written (logged). */
bool history_import(const struct import_params *params, struct diag *diag, struct import_counts *counts);

#endif
