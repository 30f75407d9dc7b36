/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Queries of recorded history: series over time, and all readings at one instant. Read only; works while a daemon is recording.
   Functions that return int return 0 or -errno, already logged. Thread: one per reader. */
#ifndef HISTORY_HISTORY_H
#define HISTORY_HISTORY_H
#include "history/month_file.h"
#include "plant/plant.h"
#include "value/snapshot.h"

static const int64_t HISTORY_SETTLED_US = 3 * 1000000; /* microseconds; points newer than this may not be in the file completely yet */

/* Returns the plant's tags as history files describe them; free with mem_free(); names belong to the plant. */
struct history_tag *history_tags(const struct plant *plant);

struct history_reader;
/* Creates a reader, never NULL; the folder need not exist yet. */
struct history_reader *history_reader_create(struct log *log, const char *folder);
/* Makes the reader convert all series to the units in which this plant shows its tags; without this call, values have the units of the
   time of recording. (history_at() converts by its own `tags`.) `plant` must outlive the reader. */
void history_reader_show_by(struct history_reader *reader, const struct plant *plant);
void history_reader_destroy(struct history_reader **reader); /* Frees the reader and sets *reader to NULL; accepts a pointer to NULL. */

/* A series of one tag: its points or, if there are more points than requested, buckets of equal length (intervals). Both show spikes in
   full. */
struct history_series {
    bool step;
    struct history_points points; /* points, ascending; including the last one before and the first one after the requested time span */
    int64_t bucket_us;            /* length of a bucket; 0: the series consists of points, not buckets */
    /* buckets, ascending; the first one begins at or before the requested time span and the last one ends after it, if there are such
       buckets. Between two buckets that do not adjoin, the line is straight; if the tag is a switch, the value holds instead */
    struct history_buckets buckets;
};
/* Reads the series of a tag between two times: its points if they are at most max_points, else buckets. */
int history_series(struct history_reader *reader, const char *tag, int64_t from_us, int64_t to_us, int max_points,
                   struct history_series *out);
/* Reads the buckets of a tag between two times, even if it has few points. Each is one to two times (to_us - from_us) / max_count long,
   and begins at a multiple of its length. */
int history_intervals(struct history_reader *reader, const char *tag, int64_t from_us, int64_t to_us, int max_count,
                      struct history_series *out);
void history_series_finish(struct history_series *series);

/* Reads the hourly means of a tag: `hours` whole hours, the last of which ends at or before to_us. The mean of an hour is NaN if less than
   half of the hour has a value. */
int history_hourly(struct history_reader *reader, const char *tag, int64_t to_us, int hours, double *means);

/* Finds the times of the first and the last recorded point. Returns false if no point is recorded, or if history cannot be read
   (logged). */
bool history_span(struct history_reader *reader, int64_t *first_us, int64_t *last_us);
/* Lists the gaps between two times: spans in which no tag was recorded, although points exist before and after. The list is in order of
   time, without overlaps. Free with mem_free(out->at). */
int history_gaps(struct history_reader *reader, int64_t from_us, int64_t to_us, struct history_gaps *out);
/* Reads the readings of all tags at time t into a snapshot of the plant of `tags`. A tag that was never recorded is
   Bad_WaitingForInitialData. */
int history_at(struct history_reader *reader, const struct history_tag *tags, int64_t t_us, struct snapshot *into);

#endif
