/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Queries of recorded history: series over time, and all readings at one instant. Read only; works while a daemon is recording. Functions
   that return int return 0 or -errno, already logged. Thread: one per reader. */
#ifndef HISTORY_HISTORY_H
#define HISTORY_HISTORY_H
#include "history/month_file.h"
#include "plant/plant.h"
#include "value/snapshot.h"

static const int64_t HISTORY_SETTLED_US = 3 * 1000000; /* what is newer than this may not all be written yet */

/* Returns the plant's tags as history files describe them; free with mem_free(), names belong to the plant. */
struct history_tag *history_tags(const struct plant *plant);

struct history_reader;
struct history_reader *history_reader_create(struct log *log, const char *folder); /* never NULL; the folder need not exist yet */
/* Converts all series from now on to the units in which this plant shows its tags; without this call they are in the units of the time of
   recording. (history_at() converts by its tags.) plant must outlive the reader. */
void history_reader_show_by(struct history_reader *reader, const struct plant *plant);
void history_reader_destroy(struct history_reader **reader); /* &NULL is fine; leaves NULL */

/* A series of one tag: its points or, if there are more than were asked for, buckets of one length. Spikes are in both. */
struct history_series {
    bool step;
    struct history_points points;   /* ascending; with the last before and the first after the time asked for */
    int64_t bucket_us;              /* 0: points */
    struct history_buckets buckets; /* ascending; where one is missing the line goes straight on (a step holds) */
};
/* Reads the series of a tag between two times. */
int history_series(struct history_reader *reader, const char *tag, int64_t from_us, int64_t to_us, int max_points,
                   struct history_series *out);
void history_series_finish(struct history_series *series);

/* Reads means of a tag over whole hours: `hours` of them, to the last one that is over at to_us. Each is that of its line; NaN where under
   half of the hour has a value. */
int history_hourly(struct history_reader *reader, const char *tag, int64_t to_us, int hours, double *means);

/* Finds the first and the last time of what is recorded. Returns false if there is nothing, or it cannot be read (logged). */
bool history_span(struct history_reader *reader, int64_t *first_us, int64_t *last_us);
/* Lists the times between from and to when nothing at all was recorded, though something was before and after; ascending, without
   overlaps. Free with mem_free(out->at). */
int history_gaps(struct history_reader *reader, int64_t from_us, int64_t to_us, struct history_gaps *out);
/* Reads the readings of all tags at time t, into a snapshot of the plant that the tags are from. What was never recorded is
   Bad_WaitingForInitialData. */
int history_at(struct history_reader *reader, const struct history_tag *tags, int64_t t_us, struct snapshot *into);

#endif
