/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Queries recorded history: series of one tag over time, and the readings of all tags at one time. Never writes; works while a
   daemon is recording. Functions that return int return 0 or -errno, already logged. Use each reader in one thread only. */
#ifndef HISTORY_HISTORY_H
#define HISTORY_HISTORY_H
#include "history/month_file.h"
#include "plant/plant.h"
#include "value/snapshot.h"

/* Points younger than this, in microseconds, need not be in the history file yet, because the historian writes only once a
   second. */
static const int64_t HISTORY_SETTLED_US = 3 * 1000000;

/* Returns an array that describes the plant's tags for history files; free with mem_free(). The names belong to the plant. */
struct history_tag *history_tags(const struct plant *plant);

struct history_reader;
/* Creates a reader of the history files in a folder, which need not exist yet. Never returns NULL. */
struct history_reader *history_reader_create(struct log *log, const char *folder);
/* Makes the reader convert all series to the units in which `plant` shows its tags; without this call, values keep the units in
   which they were recorded. history_at() always converts to the units in its argument `tags`. `plant` must outlive the reader. */
void history_reader_show_by(struct history_reader *reader, const struct plant *plant);
void history_reader_destroy(struct history_reader **reader); /* Frees the reader and sets *reader to NULL; accepts a pointer to NULL. */

/* The series of one tag: its points or, if there are more than requested, buckets (intervals of equal length) with minimum and
   maximum. Both show short spikes at their true height. */
struct history_series {
    bool step;
    struct history_points points; /* points, ascending, including the last one before and the first one after the requested time span */
    int64_t bucket_us;            /* length of a bucket in microseconds; 0: the series consists of points, not buckets */
    /* buckets, ascending. The first begins at or before the requested time span and the last ends after it, if such buckets
       exist. Between buckets that are not adjacent, the value follows a straight line, or holds if the tag is a switch */
    struct history_buckets buckets;
};
/* Reads the series of a tag between two times: points if there are at most max_points, otherwise buckets. */
int history_series(struct history_reader *reader, const char *tag, int64_t from_us, int64_t to_us, int max_points,
                   struct history_series *out);
/* Reads the buckets of a tag between two times, even if it has few points. Each bucket is one to two times (to_us - from_us) /
   max_count long, and begins at a multiple of its length. */
int history_intervals(struct history_reader *reader, const char *tag, int64_t from_us, int64_t to_us, int max_count,
                      struct history_series *out);
void history_series_finish(struct history_series *series);

/* Computes a tag's means over `hours` whole hours, the last of which ends at or before to_us. A mean is NaN if the tag has a
   value for less than half of the hour. */
int history_hourly(struct history_reader *reader, const char *tag, int64_t to_us, int hours, double *means);

/* Finds the times of the first and the last recorded point. Returns false if no point is recorded, or if history cannot be read
   (logged). */
bool history_span(struct history_reader *reader, int64_t *first_us, int64_t *last_us);
/* Lists the gaps between two times: spans in which no tag was recorded, although points exist before and after. The list is in
   order of time, without overlaps. Free with mem_free(out->at). */
int history_gaps(struct history_reader *reader, int64_t from_us, int64_t to_us, struct history_gaps *out);
/* Reads the readings of all tags at time t_us into a snapshot for the plant of `tags`. A tag that was never recorded is
   Bad_WaitingForInitialData. */
int history_at(struct history_reader *reader, const struct history_tag *tags, int64_t t_us, struct snapshot *into);

#endif
