/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes and reads one month of history in one SQLite file. HISTORY.md describes its tables. Functions that return int return 0
   or -errno, already logged. Call from one thread at a time per handle; readers have handles of their own. */
#ifndef HISTORY_MONTH_FILE_H
#define HISTORY_MONTH_FILE_H
#include <stddef.h>

#include "base/log/log.h"
#include "history/point.h"
#include "history/rollup.h"
#include "plant/plant.h"

enum { HISTORY_VERSION = 3 };
enum history_level { LEVEL_1_MIN, LEVEL_10_MIN, LEVEL_1_H, LEVEL_COUNT };
extern const int64_t history_level_us[LEVEL_COUNT];

struct history_tag {
    const char *name, *unit;
    bool step;        /* true: the tag is a switch, whose values hold until the next point */
    /* largest allowed difference, in the tag's unit, between any reading and the recorded line (straight from each recorded
       point to the next) */
    double within;
    int64_t stale_us; /* microseconds for which a reading stays usable after its arrival; INT64_MAX: always */
};

struct history_row {
    int tag; /* index of the row's tag in the array `tags` that was passed to month_file_open() */
    struct history_point point;
};

struct history_points { /* a list of points; zero-initialise; free the array `at` with mem_free() */
    struct history_point *at;
    size_t count, capacity;
    /* functions that read a time span may stop once `at` contains more than this many points of the span; 0: no limit */
    size_t max;
    bool step;
};
/* Returns true if more than points->max points have been read, so that reading may stop. */
static inline bool history_points_full(const struct history_points *points)
{
    return points->max && points->count > points->max;
}
struct history_buckets { /* a list of rollup buckets; zero-initialise; free the array `at` with mem_free() */
    struct history_bucket *at;
    size_t count, capacity;
};

struct month_file;

/* Returns true if values can be converted from the unit `from` to the unit `to`, and sets *change to the conversion. A blank
   unit matches all units, without conversion, because the unit was not stated. */
bool history_unit_fits(const char *from, const char *to, struct unit_change *change);

/* Opens the history file of a month for writing; creates it if it is missing. A damaged file is renamed
   (history-2026-11.damaged-TIME.sqlite, logged) and replaced with a new one; a file of an older version is upgraded. `tags`
   must outlive the returned handle. Returns NULL on failure, with *error -errno. */
struct month_file *month_file_open(struct log *log, const char *folder, int month, const struct history_tag *tags, size_t tag_count,
                                   int *error);
/* Opens the history file of a month, of any version up to this one, for reading. Returns NULL on failure; *error is -ENOENT if
   the file does not exist. */
struct month_file *month_file_read(struct log *log, const char *folder, int month, int *error);
/* From now on, converts points and buckets that are read to the units in which `plant` shows its tags. `plant` must outlive the file. */
void month_file_show_by(struct month_file *file, const struct plant *plant);
void month_file_close(struct month_file **file); /* Closes a month's file and sets *file to NULL; accepts a pointer to NULL. */
/* Closes a damaged file and renames it to history-2026-11.damaged-TIME.sqlite, as month_file_open() does. */
void month_file_set_aside(struct month_file **file);
int month_file_month(const struct month_file *file);
/* Returns true if the open file still has its name: it has not been deleted, renamed or replaced. */
bool month_file_is_there(const struct month_file *file);

/* Writes recorded rows in one transaction, which is on disk when the function returns. held: newest samples that are not
   recorded yet, at most one per tag; each replaces its tag's stored held sample, while other tags keep theirs. Returns -ENOSPC
   if the disk is full, -EROFS if it is read-only, or -EBADMSG if the file is damaged (then open it again). */
int month_file_write(struct month_file *file, const struct history_row *rows, size_t count, const struct history_row *held,
                     size_t held_count);
/* Makes the file copy each point that is recorded or imported from now on to the outbox, in the same transaction. The outbox is
   the table of points yet to be sent to PostgreSQL (history/month_outbox.h). */
int month_file_use_outbox(struct month_file *file);
/* Moves the points written since the last call into compressed blocks by tag, and updates the rollups (minimum, maximum and
   mean of intervals). month_file_waiting() returns an estimate of the number of points not yet in blocks. */
int month_file_tidy(struct month_file *file);
size_t month_file_waiting(const struct month_file *file);
/* Writes ascending points of one tag, anywhere in the month, and updates the rollups. */
int month_file_import(struct month_file *file, int tag, const struct history_point *points, size_t count);
/* Deletes the points between two times that mark a gap in recording (by their quality). Call it before importing points for
   that time. */
int month_file_forget_gaps(struct month_file *file, int64_t from_us, int64_t to_us, uint32_t gap_quality);
/* Recovers after the daemon that wrote this file was killed: records the newest samples that it left, each followed by a point
   that marks a gap. *ended_us receives the time when that daemon ended. sends_gaps: also puts the gap points into the outbox
   (points to send to PostgreSQL), if there is one. Otherwise, only the samples go there, because another daemon is recording
   now and continues the lines. */
int month_file_recover(struct month_file *file, uint32_t gap_quality, bool sends_gaps, int64_t *ended_us);
/* Deletes the held rows (newest samples that were not recorded when they were stored) of a past month, because all of these
   samples are recorded by then. */
int month_file_clear_held(struct month_file *file);
/* Deletes points older than a time, but only those that month_file_tidy() has moved to blocks. The freed space stays in the
   file for new points; with `shrink` it is returned to the disk, if the file can shrink (struct month_file_size). Also deletes
   points of that age from the outbox (points to send to PostgreSQL), and adds their number to *unsent. */
int month_file_cut(struct month_file *file, int64_t until_us, bool shrink, int64_t *unsent);
struct month_file_size {
    int64_t bytes, free_bytes; /* bytes: size of the file on disk; free_bytes: unused space within it */
    bool shrinks;
};
int month_file_size(struct month_file *file, struct month_file_size *size);
/* Writes an event (a time with a kind and a text) to the file's table of events. */
int month_file_note(struct month_file *file, int64_t t_us, const char *kind, const char *text);

/* Begins a read transaction, ended by month_file_end_read(): all reads in between are consistent, even if another handle writes
   in the meantime. */
int month_file_begin_read(struct month_file *file);
void month_file_end_read(struct month_file *file);
/* Appends a tag's points between two times, ascending, with the last point before and the first point after that span if the
   file has them. Omits points whose unit cannot be converted to the plant's, as do the functions below. */
int month_file_points(struct month_file *file, const char *tag, int64_t from_us, int64_t to_us, struct history_points *out);
/* A tag's points that are omitted, because their unit cannot be converted to the plant's; zero-initialise. */
struct history_left_out {
    size_t count;
    char unit[32]; /* unit in which the first omitted point was recorded */
};
/* Counts a tag's points between two times that are omitted because of their unit, and adds them to *out. */
int month_file_left_out(struct month_file *file, const char *tag, int64_t from_us, int64_t to_us, struct history_left_out *out);
/* A tag's rollup buckets in a month's file; zero-initialise. */
struct month_buckets {
    struct history_buckets buckets;
    int64_t until_us; /* end of the last bucket in the file; from_us if it has none */
    bool step;        /* true if the tag is a switch; unchanged if the file does not have the tag */
};
/* Appends a tag's rollup buckets that begin in from_us..to_us, and the last bucket that begins before. */
int month_file_buckets(struct month_file *file, const char *tag, enum history_level level, int64_t from_us, int64_t to_us,
                       struct month_buckets *out);
/* A time span in which nothing was recorded: the daemon did not run, or the clock was set forward. */
struct history_gap {
    int64_t from_us, to_us;
};
struct history_gaps {
    struct history_gap *at; /* array of `count` gaps in recording; free with mem_free() */
    size_t count, capacity;
};
/* Appends the gaps in recording that are noted in this file, in no particular order. */
int month_file_gaps(struct month_file *file, struct history_gaps *out);
/* Finds the times of the first and the last point. Returns 0 and leaves both unchanged if the file has no points. */
int month_file_span(struct month_file *file, int64_t *first_us, int64_t *last_us);
/* A tag's points on either side of a requested time: the last one before or at it, and the first one after it. A point's t_us
   is INT64_MIN until it is found. */
struct history_pair {
    struct history_point before, after;
    bool step;
    struct unit_change change; /* converts values of the last file read to the unit in which the plant shows the tag */
};
/* Finds for all tags the points around t_us. Skips points that earlier calls, for other months' files, have already found. So
   pass the file of t_us's month first, then earlier ones, newest first, and then later ones, oldest first. */
int month_file_at(struct month_file *file, int64_t t_us, const struct history_tag *tags, size_t count, struct history_pair *pairs);

#endif
