/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One month of history in one SQLite file: what is written to it and read from it. HISTORY.md describes its tables.
   Thread: one at a time; readers have a handle of their own. Functions that return int: 0 or -errno, already logged once. */
#ifndef HISTORY_MONTH_FILE_H
#define HISTORY_MONTH_FILE_H
#include <stddef.h>

#include "base/log.h"
#include "history/point.h"
#include "history/rollup.h"
#include "plant/plant.h"

enum { HISTORY_VERSION = 2 };
enum history_level { LEVEL_10_S, LEVEL_1_MIN, LEVEL_10_MIN, LEVEL_1_H, LEVEL_COUNT };
extern const int64_t history_level_us[LEVEL_COUNT];

struct history_tag {
    const char *name, *unit;
    bool step;     /* a switch: values hold until the next */
    double within; /* what is given back is within this of what was read */
};

struct history_row {
    int tag; /* index in the tags that the file was opened for */
    struct history_point point;
};

struct history_points { /* zero-initialise; free at with mem_free */
    struct history_point *at;
    size_t count, capacity;
    bool step;
};
struct history_buckets { /* likewise */
    struct history_bucket *at;
    size_t count, capacity;
};

struct month_file;

/* To write, made where it is missing; a damaged one is renamed (history-2026-11.damaged-TIME.sqlite), said so, and a new one is begun.
   One of an older version is brought up to this one, with all that is in it. tags must outlive it. NULL: *error says why. */
struct month_file *month_file_open(struct log *log, const char *folder, int month, const struct history_tag *tags, size_t tag_count,
                                   int *error);
/* Of a month that has a file already, of any version until this one, to read. -ENOENT: it has none. */
struct month_file *month_file_read(struct log *log, const char *folder, int month, int *error);
/* Points and buckets are given in the units in which this plant shows its tags, whatever they were then. plant outlives the file. */
void month_file_show_by(struct month_file *file, const struct plant *plant);
void month_file_close(struct month_file **file); /* &NULL is fine; leaves NULL */
/* Found damaged while in use: closes it and puts it out of the way. */
void month_file_set_aside(struct month_file **file);
int month_file_month(const struct month_file *file);
bool month_file_is_there(const struct month_file *file); /* false: deleted or set aside by somebody else, or replaced */

/* All of it or nothing, on disk when it returns. held: the newest sample of tags whose door is open, in place of the one before.
   -ENOSPC: full; -EROFS; -EBADMSG: damaged (open again). */
int month_file_write(struct month_file *file, const struct history_row *rows, size_t count, const struct history_row *held,
                     size_t held_count);
/* Brings what was written into the order of tags, and rolls it up. How many rows wait for it: month_file_waiting. */
int month_file_tidy(struct month_file *file);
size_t month_file_waiting(const struct month_file *file);
/* Points of any time, of one tag, ascending; rolls up what they change. */
int month_file_import(struct month_file *file, int tag, const struct history_point *points, size_t count);
/* What was held when the last writer ended becomes part of the line, and a gap is set behind it; *ended_us: when it ended. */
int month_file_recover(struct month_file *file, uint32_t gap_quality, int64_t *ended_us);
int month_file_clear_held(struct month_file *file); /* all that was held is written: the month is over */
int month_file_note(struct month_file *file, int64_t t_us, const char *kind, const char *text); /* in the table of events */

/* What is read between these two is of one moment, whatever is written meanwhile. */
int month_file_begin_read(struct month_file *file);
void month_file_end_read(struct month_file *file);
/* Appends the points in from..to, with the last before and the first after where the file has them. Ascending. */
int month_file_points(struct month_file *file, const char *tag, int64_t from_us, int64_t to_us, struct history_points *out);
/* Appends what is rolled up of whole or part buckets in from..to; *until_us: where that ends. */
int month_file_buckets(struct month_file *file, const char *tag, enum history_level level, int64_t from_us, int64_t to_us,
                       struct history_buckets *out, int64_t *until_us);
/* Appends the times when nothing was recorded at all, of which this file tells: nobody did, or the clock was set forward. In no order. */
struct history_gap {
    int64_t from_us, to_us;
};
struct history_gaps {
    struct history_gap *at; /* mem_free */
    size_t count, capacity;
};
int month_file_gaps(struct month_file *file, struct history_gaps *out);
/* When the first and the last of its points were; left as they are where it has none. */
int month_file_span(struct month_file *file, int64_t *first_us, int64_t *last_us);
/* Of each tag, what lies before or at t, and after; t_us INT64_MIN in a point that is not there. Only those are looked for: the month
   of t is asked before its neighbours. */
struct history_pair {
    struct history_point before, after;
    bool step;
    struct unit_change change; /* from the unit of the file that was read last */
};
int month_file_at(struct month_file *file, int64_t t_us, const struct history_tag *tags, size_t count, struct history_pair *pairs);

#endif
