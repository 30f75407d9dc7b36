/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The alarm journal's SQLite file. Functions that return int return 0 or -errno, already logged. Use each file in one thread only. */
#ifndef ALARM_JOURNAL_FILE_H
#define ALARM_JOURNAL_FILE_H
#include "alarm/alarms.h"
#include "base/log/log.h"

#define JOURNAL_FILE "alarms.sqlite"
enum { JOURNAL_VERSION = 2, JOURNAL_UNIT_BYTES = 64 };

struct journal_entry {
    struct alarm alarm; /* the alarm, with its state at utc_ns. Priority 0: unknown; the row then gets that of the alarm's newest row */
    bool changed;       /* true: the alarm changed, so a journal row is written too; false: only the alarm's current state is written */
    enum alarm_event event;
    enum alarm_status before, after;
    int64_t utc_ns;
    double value;
    bool has_unit; /* false: the unit of value and limit is unknown */
    char tag[256], unit[JOURNAL_UNIT_BYTES], who[ALARM_NAME_BYTES], reason[ALARM_REASON_BYTES];
};

struct journal_row {
    int64_t id, t_us;
    const char *tag, *kind, *event, *before, *after, *who, *reason; /* texts of the journal row, valid until the next row is read */
    int priority;
    double limit, value; /* the alarm's limit and the value of the change; NaN: none */
    const char *unit;    /* unit of limit and value when the row was written; NULL: unknown, because version 1 wrote the row */
};
struct journal_query {
    int64_t from_us, to_us;
    int64_t before_id; /* returns only journal rows with a smaller id, that is, the preceding page of the list; INT64_MAX: all rows */
    const char *tag;   /* name of the tag whose journal rows to return; NULL: all tags */
    int limit;         /* maximum number of journal rows to return, newest first */
};

struct journal_file;
/* Opens the journal's file for writing; creates folder and file if missing. *renewed true: a damaged file was renamed and
   replaced by an empty one. Returns NULL with *error on failure. */
struct journal_file *journal_file_open(struct log *log, const char *folder, bool *renewed, int *error);
/* Opens the journal's file for reading. Returns NULL with *error on failure; *error 0: the file does not exist. */
struct journal_file *journal_file_read(struct log *log, const char *folder, int *error);
void journal_file_close(struct journal_file **file); /* closes the file and sets *file to NULL; accepts a pointer to NULL */
/* Writes all entries in one transaction, except changes already in the file. Returns -EBADMSG if the file is damaged. */
int journal_file_write(struct journal_file *file, const struct journal_entry *entries, size_t count);
int journal_file_forget(struct journal_file *file, int64_t before_us); /* deletes journal rows (changes of alarms) older than before_us */
/* Calls each() for the stored state of every alarm that was not normal at the last write to the journal, with priority 0.
   unit: unit of the alarm's value; NULL: unknown. */
int journal_file_states(struct journal_file *file,
                        void (*each)(void *arg, const char *tag, const char *unit, const struct alarm *alarm), void *arg);
int journal_file_rows(struct journal_file *file, const struct journal_query *query, void (*each)(void *arg, const struct journal_row *row),
                      void *arg);
int journal_file_at(struct journal_file *file, int64_t t_us, void (*each)(void *arg, const struct journal_row *row), void *arg);

#endif
