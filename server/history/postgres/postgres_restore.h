/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the past of a plant from PostgreSQL into the files of months of a machine that has none: the newest month first, a month at a time.
   Where it stands is in a file of the folder, so it goes on after a restart. Thread: one. */
#ifndef HISTORY_POSTGRES_POSTGRES_RESTORE_H
#define HISTORY_POSTGRES_POSTGRES_RESTORE_H
#include "history/month_file.h"
#include "history/postgres/postgres_tables.h"

struct postgres_restore {
    struct log *log;
    const struct plant *plant;
    const struct history_tag *tags; /* of the plant */
    const char *folder;
    bool wanted;    /* there is something to do */
    int next_month; /* INT_MAX: not begun */
    int64_t points; /* so far */
    bool begins;    /* the lines of whoever recorded there before have ended, or are another's who goes on */
};

/* Finds out whether the folder needs its past: there is no month in it, or an earlier run has not finished. Makes the folder. */
void postgres_restore_init(struct postgres_restore *restore, struct log *log, const struct plant *plant, const struct history_tag *tags,
                           const char *folder);
/* Ends the lines of whoever recorded there before, where it ended. Returns false on failure of the server. */
bool postgres_restore_end_lines(struct postgres_tables *tables, int64_t now_us);
/* Of the time between the last sample that was heard of whoever led, and our own first: lines that it went on with behind a cut end where
   it ended, and not where it was heard last. Returns false on failure of the server. */
bool postgres_restore_end_span(struct postgres_tables *tables, int64_t from_us, int64_t to_us);
/* Reads the points between two times, of all tags, in place of the gap that the files have there. Returns false on failure, as below. */
bool postgres_restore_span(struct postgres_restore *restore, struct postgres_tables *tables, int64_t from_us, int64_t to_us,
                           int64_t *points, char why[POSTGRES_WHY_BYTES]);
/* Reads one more month; *points: how many came. Returns false on failure of the server, or of the files (logged, and why says so). The
   first call ends the lines of whoever recorded there before, and comes before anything is written there. */
bool postgres_restore_step(struct postgres_restore *restore, struct postgres_tables *tables, int64_t now_us, int64_t *points,
                           char why[POSTGRES_WHY_BYTES]);

#endif
