/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Imports samples from a CSV file into history, for example from before Plantcast was installed. Works while a daemon is recording. */
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
    const char *encoding; /* character encoding of the file; NULL: detected from its bytes */
    /* UTC time in microseconds that corresponds to 0 in the time column; INT64_MIN: the column has timestamps instead */
    int64_t start_us;
    int64_t unit_us;        /* microseconds per unit of the numbers in the time column */
    /* longest time in microseconds between two samples that counts as continuous recording, not as a gap; 0: chosen for each
       tag */
    int64_t longest_gap_us;
};

struct import_counts {
    long long samples, points; /* samples: number of samples read; points: number of points recorded */
    /* bad: samples without a usable value; duplicates: samples replaced by a later row with the same time; gaps: times without
       samples, which interrupt the line through the tag's recorded points */
    long long bad, duplicates, gaps;
    int tags;
    struct charset_choice encoding;
    bool exported; /* true: the file has the columns of `plantcast history export` */
    int64_t from_us, to_us;
    /* [0] the smallest, [1] the largest limit that was used for a tag, in microseconds: a longer time between two samples of
       the tag counts as a gap in recording */
    int64_t longest_us[2];
};

/* Imports a CSV file with samples in one of two forms. Long form: columns Tag, Time, Value and optionally Quality (0x80050000,
   Good, Uncertain, Bad) and Unit. Without a unit, values are in the unit of the tag's row in the tag list (own_unit), as a
   device sends them. Wide form: a column Time, then one column per tag. A blank cell or a state word (value/state_word.h) is a
   Bad sample. The rows of each tag must ascend in time; of rows with equal times the last one counts. A point without a value
   (Bad_NoCommunication) is recorded after the last sample before a gap, and after the end of a series that no recorded point
   follows. The longest time between samples that is not a gap is longest_gap_us. If longest_gap_us is 0, the limit is `Stale s`
   (a column of the tag list), provided that the tag's row states it and samples do not arrive more slowly; otherwise, ten times
   the median spacing of the series. A series of two samples uses the median over all other series; if there are none, `Stale s`
   or twice override_s (the plant's maximum time between two recorded points). An exported file has points of recorded lines
   instead of samples: there, a time of up to twice override_s is never a gap, and a tag that is never stale has no gaps. Errors
   and warnings go to diag; after any error nothing is imported. Returns false on errors, or if the folder cannot be written
   (logged). */
bool history_import(const struct import_params *params, struct diag *diag, struct import_counts *counts);

#endif
