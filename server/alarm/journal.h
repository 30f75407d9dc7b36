/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The alarm journal, alarms.sqlite in the history folder: one row for each change of an alarm, and the current state of each
   alarm. A thread of its own writes rows within 0.25 s. Rows that cannot be written stay in memory, up to a limit, and are
   retried. ALARMS.md describes the tables. */
#ifndef ALARM_JOURNAL_H
#define ALARM_JOURNAL_H
#include "alarm/journal_file.h"
#include "base/files/settling.h"
#include "base/log/log.h"
#include "base/metrics/counters.h"

struct journal_params {
    struct log *log;
    struct counters *counters;
    const char *folder; /* folder of the journal, created if missing */
    double keep_days;
    bool reloads; /* true: the caller copies the states of alarms that the plant had before a reload over the restored ones */
    /* true: adds a row for each alarm in the file that was not normal, and that `alarms` does not have, or whose state its settings in
       `alarms` do not support */
    bool adds_ended;
    int error_before; /* last journal_error() of the journal that this one replaces; holds until the file is written. 0: none */
};

/* Opens the journal, restores the states of `alarms` from it, and starts the thread that writes the journal. A damaged file is
   renamed. Returns NULL if the thread cannot start (logged). */
struct journal *journal_start(const struct journal_params *params, struct alarms *alarms, struct instant now);
/* Writes pending rows and ends the thread. Accepts a pointer to NULL; sets *journal to NULL. Returns true if all rows are on disk. */
bool journal_stop(struct journal **journal);
/* This function and the next two tell whether the journal rows queued between journal_begin() and journal_end() are on disk
   (base/files/settling.h). journal_end() makes the thread write them immediately, even after a failed attempt. None of the
   three functions waits for the disk. */
struct settling_ticket journal_begin(struct journal *journal);
void journal_end(struct journal *journal, struct settling_ticket *ticket);
int journal_settled(struct journal *journal, const struct settling_ticket *ticket);
/* Returns 0 if the journal's file was usable at the last attempt to read or write it, otherwise -errno. */
int journal_error(struct journal *journal);
/* Returns the journal row for a change of an alarm; texts are copied. unit: unit of the change's value and limit; NULL: unknown. */
struct journal_entry journal_entry_of(const struct alarm_change *change, const char *tag, const char *unit);
/* Returns the row of an alarm that became normal because the plant's settings changed. alarm: the alarm before this change. */
struct journal_entry journal_entry_of_ended(const struct alarm *alarm, const char *tag, const char *unit, int64_t utc_ns,
                                            const char *reason);
/* queues a journal row for writing; never blocks */
void journal_add_entry(struct journal *journal, const struct journal_entry *entry);
/* Returns true once after a new journal file was created. The file lacks the current alarm states, so the caller must pass each
   alarm that is not normal to journal_keep(). */
bool journal_asks(struct journal *journal);
/* Queues the current state of an alarm to be written to the journal's table of states. */
void journal_keep(struct journal *journal, const struct alarm *alarm, const char *tag, const char *unit);

/* --- functions that read the journal; thread: one per reader --- */
/* Calls each() for the journal rows that match the query. Returns 0 or -errno (logged); a folder without a journal has no rows. */
int journal_read(struct log *log, const char *folder, const struct journal_query *query,
                 void (*each)(void *arg, const struct journal_row *row), void *arg);
/* Calls each() for every alarm that was not normal at t_us, with its newest journal row up to t_us. Returns 0 or -errno (logged). */
int journal_at(struct log *log, const char *folder, int64_t t_us, void (*each)(void *arg, const struct journal_row *row), void *arg);

#endif
