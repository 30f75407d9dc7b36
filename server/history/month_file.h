/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One month of history in one SQLite file: writing to it and reading from it. HISTORY.md describes its tables. Functions that return int
   return 0 or -errno, already logged. Thread: one at a time per handle; readers have handles of their own. */
#ifndef HISTORY_MONTH_FILE_H
#define HISTORY_MONTH_FILE_H
#include <stddef.h>

#include "base/log/log.h"
#include "history/point.h"
#include "history/rollup.h"
#include "plant/plant.h"

enum { HISTORY_VERSION = 2 };
enum history_level { LEVEL_10_S, LEVEL_1_MIN, LEVEL_10_MIN, LEVEL_1_H, LEVEL_COUNT };
extern const int64_t history_level_us[LEVEL_COUNT];

struct history_tag {
    const char *name, *unit;
    bool step;     /* a switch: values hold until the next */
    double within; /* the recorded line is within this of every reading */
    int64_t stale_us; /* how long a reading may be used after it arrived; INT64_MAX: always */
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

/* Opens the file of a month for writing, and makes it if it is missing. A damaged file is renamed (history-2026-11.damaged-TIME.sqlite,
   logged) and a new one is begun; a file of an older version is converted. tags must outlive it. Returns NULL on failure, with *error. */
struct month_file *month_file_open(struct log *log, const char *folder, int month, const struct history_tag *tags, size_t tag_count,
                                   int *error);
/* Opens the file of a month for reading, of any version up to this one. Returns NULL on failure; *error is -ENOENT if there is no file. */
struct month_file *month_file_read(struct log *log, const char *folder, int month, int *error);
/* Converts points and buckets from now on to the units in which this plant shows its tags. plant must outlive the file. */
void month_file_show_by(struct month_file *file, const struct plant *plant);
void month_file_close(struct month_file **file); /* &NULL is fine; leaves NULL */
/* Closes a file that turned out to be damaged and renames it, as above. */
void month_file_set_aside(struct month_file **file);
int month_file_month(const struct month_file *file);
/* Returns whether the open file is still that of its name: it was not deleted, renamed or replaced meanwhile. */
bool month_file_is_there(const struct month_file *file);

/* Writes rows in one transaction, which is on disk when this returns. held: newest samples that are not recorded yet; each replaces the
   held sample of its tag, other tags keep theirs. Returns -ENOSPC if the disk is full, -EROFS, or -EBADMSG if the file is damaged (open it
   again). */
int month_file_write(struct month_file *file, const struct history_row *rows, size_t count, const struct history_row *held,
                     size_t held_count);
/* From now on each point that is recorded or imported goes, in the same transaction, to the table of those that another database has yet to
   be sent (history/month_outbox.h), too. */
int month_file_use_outbox(struct month_file *file);
/* Makes the next month_file_tidy() take rollups from the file: somebody else has imported into it. */
void month_file_forget_rollups(struct month_file *file);
/* Sorts the rows that were written by tag and makes rollups of them. month_file_waiting() returns how many rows wait for that. */
int month_file_tidy(struct month_file *file);
size_t month_file_waiting(const struct month_file *file);
/* Writes points of one tag, ascending, of any time of the month, and updates the rollups. */
int month_file_import(struct month_file *file, int tag, const struct history_point *points, size_t count);
/* Deletes points of a quality between two times: of a gap that is known better now. Points of these times are imported next. */
int month_file_forget_gaps(struct month_file *file, int64_t from_us, int64_t to_us, uint32_t gap_quality);
/* Recovers from a writer that did not end properly: records its newest samples, each followed by a gap. sends_gaps: gaps are put into the
   outbox too, where there is one; else samples alone, since another daemon records now. *ended_us: when it ended. */
int month_file_recover(struct month_file *file, uint32_t gap_quality, bool sends_gaps, int64_t *ended_us);
int month_file_clear_held(struct month_file *file); /* deletes the newest samples: all are recorded, the month is over */
/* Deletes what is older than a time, as far as it has been tidied. The room that it leaves is for what comes next; with `shrink`, the disk
   gets it back, if the file was begun with auto_vacuum (struct month_file_size, shrinks). *unsent is increased by how many of the points
   that waited in its outbox were as old, and are deleted too. */
int month_file_cut(struct month_file *file, int64_t until_us, bool shrink, int64_t *unsent);
struct month_file_size {
    int64_t bytes, free_bytes; /* on disk; of these, for what comes next */
    bool shrinks;
};
int month_file_size(struct month_file *file, struct month_file_size *size);
int month_file_note(struct month_file *file, int64_t t_us, const char *kind, const char *text); /* writes a row of the table of events */

/* Begin and end a read transaction: all that is read between is consistent, whatever is written meanwhile. */
int month_file_begin_read(struct month_file *file);
void month_file_end_read(struct month_file *file);
/* Appends the points of a tag between two times, ascending, with the last point before and the first after if the file has them. */
int month_file_points(struct month_file *file, const char *tag, int64_t from_us, int64_t to_us, struct history_points *out);
/* Appends the rollup buckets of a tag that overlap from..to; *until_us: up to when there are rollups. */
int month_file_buckets(struct month_file *file, const char *tag, enum history_level level, int64_t from_us, int64_t to_us,
                       struct history_buckets *out, int64_t *until_us);
/* A time when nothing was recorded: the daemon did not run, or the clock was set forward. */
struct history_gap {
    int64_t from_us, to_us;
};
struct history_gaps {
    struct history_gap *at; /* mem_free */
    size_t count, capacity;
};
/* Appends the gaps that this file knows of, in no order. */
int month_file_gaps(struct month_file *file, struct history_gaps *out);
/* Finds the times of the first and the last point. Returns 0 and leaves both as they are if there is none. */
int month_file_span(struct month_file *file, int64_t *first_us, int64_t *last_us);
/* The points of a tag around a time: the last one before or at it, and the first one after; t_us is INT64_MIN in a point not found yet. */
struct history_pair {
    struct history_point before, after;
    bool step;
    struct unit_change change; /* from the unit of the file that was read last */
};
/* Finds the points of all tags around t_us. Looks only for those not found yet, so the month of t_us is read before its neighbours. */
int month_file_at(struct month_file *file, int64_t t_us, const struct history_tag *tags, size_t count, struct history_pair *pairs);

#endif
