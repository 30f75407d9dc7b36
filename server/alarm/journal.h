/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What became of alarms, one row each, and how each alarm is now: alarms.sqlite beside the history. It is written by a thread of its
   own, at most 0.25 s after; what cannot be written is kept up to a bound and tried again. ALARMS.md describes the tables. */
#ifndef ALARM_JOURNAL_H
#define ALARM_JOURNAL_H
#include "alarm/alarms.h"
#include "base/counters.h"
#include "base/log.h"

#define JOURNAL_FILE "alarms.sqlite"
enum { JOURNAL_VERSION = 1 };

struct journal_params {
    struct log *log;
    struct counters *counters;
    const char *folder; /* made where it is missing */
    double keep_days;
};

/* Takes back how alarms were into those of `alarms`. A file that is damaged is set aside. NULL: no thread; logged. */
struct journal *journal_start(const struct journal_params *params, struct alarms *alarms, struct instant now);
void journal_stop(struct journal **journal); /* writes what there is; &NULL is fine; leaves NULL */
/* Does not wait. Names are copied. */
void journal_add(struct journal *journal, const struct alarm_change *change, const char *tag);
/* True, once, after the file was begun anew: journal_keep is due for each alarm that is not normal. */
bool journal_asks(struct journal *journal);
void journal_keep(struct journal *journal, const struct alarm *alarm, const char *tag);

/* --- reading; thread: one per reader --- */
struct journal_row {
    int64_t id, t_us;
    const char *tag, *kind, *event, *before, *after, *who, *reason; /* valid until the next */
    int priority;
    double limit, value; /* NaN: none */
};
struct journal_query {
    int64_t from_us, to_us;
    int64_t before_id; /* only rows of a smaller id; INT64_MAX: all */
    const char *tag;   /* NULL: all */
    int limit;         /* at most so many, the newest first */
};
/* 0 or -errno, logged. A folder without a journal has no rows. */
int journal_read(struct log *log, const char *folder, const struct journal_query *query,
                 void (*each)(void *arg, const struct journal_row *row), void *arg);
/* How each alarm was at t: its last row until then, where that is not normal. */
int journal_at(struct log *log, const char *folder, int64_t t_us, void (*each)(void *arg, const struct journal_row *row), void *arg);

#endif
