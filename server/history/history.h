/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Asking the historian what was: lines over time, and all readings at one instant. Thread: one per reader; it writes nothing, and
   works beside a daemon that records. Functions that return int: 0 or -errno, already logged. */
#ifndef HISTORY_HISTORY_H
#define HISTORY_HISTORY_H
#include "history/month_file.h"
#include "plant/plant.h"
#include "value/snapshot.h"

static const int64_t HISTORY_SETTLED_US = 3 * 1000000; /* what is newer than this may not all be written yet */

/* As the historian keeps the plant's tags. Free with mem_free; names are the plant's. */
struct history_tag *history_tags(const struct plant *plant);

struct history_reader;
struct history_reader *history_reader_create(struct log *log, const char *folder); /* never NULL; a folder may come later */
/* Series are given in the units in which this plant shows its tags, whatever they were when they were recorded; else as they were then.
   history_at does so by its tags. plant outlives the reader. */
void history_reader_show_by(struct history_reader *reader, const struct plant *plant);
void history_reader_destroy(struct history_reader **reader); /* &NULL is fine; leaves NULL */

/* One tag from..to: its points, where there are at most max_points of them; else buckets of one length. Spikes are in both. */
struct history_series {
    bool step;
    struct history_points points;   /* ascending; with the last before and the first after the time asked for */
    int64_t bucket_us;              /* 0: points */
    struct history_buckets buckets; /* ascending; where one is missing the line goes straight on (a step holds) */
};
int history_series(struct history_reader *reader, const char *tag, int64_t from_us, int64_t to_us, int max_points,
                   struct history_series *out);
void history_series_finish(struct history_series *series);

/* From when to when there is something. False: nothing is there, or it cannot be read (logged). */
bool history_span(struct history_reader *reader, int64_t *first_us, int64_t *last_us);
/* When nothing was recorded at all, though something was before and after: what overlaps from..to, ascending, none within another.
   mem_free(out->at). */
int history_gaps(struct history_reader *reader, int64_t from_us, int64_t to_us, struct history_gaps *out);
/* All readings at t, by tag index of the plant that the tags are of. What was never recorded is Bad_WaitingForInitialData. */
int history_at(struct history_reader *reader, const struct history_tag *tags, int64_t t_us, struct snapshot *into);

#endif
