/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Restores a plant's history from PostgreSQL on a machine that has none: one month at a time, newest first. A file in the
   folder stores the progress, so that the restore continues after a restart. Call from one thread only. */
#ifndef HISTORY_POSTGRES_POSTGRES_RESTORE_H
#define HISTORY_POSTGRES_POSTGRES_RESTORE_H
#include "history/month_file.h"
#include "history/postgres/postgres_tables.h"

struct postgres_restore {
    struct log *log;
    const struct plant *plant;
    const struct history_tag *tags; /* tags of the plant */
    const char *folder;
    bool wanted;    /* true: points are being restored from PostgreSQL */
    int next_month; /* next month to restore (months since January 1970); INT_MAX: the restore has not begun */
    int64_t points; /* number of points restored so far */
    /* true: points may be sent to the database, because earlier recordings there were ended with points without a value, or
       another daemon continues them */
    bool begins;
};

/* Sets restore->wanted if the folder needs a restore: it has no monthly files, or an earlier restore is unfinished. Creates the folder. */
void postgres_restore_init(struct postgres_restore *restore, struct log *log, const struct plant *plant, const struct history_tag *tags,
                           const char *folder);
/* Ends the recording of all tags in the database: writes a point without a value after each tag's last point, because its
   values are unknown from then on. Returns false if the server fails. */
bool postgres_restore_end_lines(struct postgres_tables *tables, int64_t now_us);
/* Corrects in the database, between from_us (last sample received from the former leader) and to_us (our own first sample),
   where recordings end. A recording ends with a point without a value. If the former leader recorded further points of a tag
   after such an end, the end is moved behind the tag's last point. Returns false if the server fails. */
bool postgres_restore_end_span(struct postgres_tables *tables, int64_t from_us, int64_t to_us);
/* Copies the points of all tags between two times from the database to the files, in place of the gap there. Returns false if
   the server fails or the files cannot be written (logged, reason in `why`). */
bool postgres_restore_span(struct postgres_restore *restore, struct postgres_tables *tables, int64_t from_us, int64_t to_us,
                           int64_t *points, char why[POSTGRES_WHY_BYTES]);
/* Restores one more month from the database, and sets *points to the number of its points. Returns false if the server fails,
   or if the files cannot be written (reason in `why`). Unless restore->begins is set, the first call of a restore also ends the
   recordings that are already in the database. To do so, it adds a point without a value right after each tag's last point.
   This daemon must not send points to the database before that call. */
bool postgres_restore_step(struct postgres_restore *restore, struct postgres_tables *tables, int64_t now_us, int64_t *points,
                           char why[POSTGRES_WHY_BYTES]);

#endif
