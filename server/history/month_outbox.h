/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Outbox: the points in a month's file that are yet to be sent to PostgreSQL. The historian writes them in the same transaction
   as the points themselves (month_file_use_outbox()); the sender reads and deletes them through a handle of its own. Use each
   handle in one thread only. Functions that return int return 0 or -errno, already logged. */
#ifndef HISTORY_MONTH_OUTBOX_H
#define HISTORY_MONTH_OUTBOX_H
#include <stddef.h>

#include "base/log/log.h"
#include "history/point.h"

#define MONTH_OUTBOX_SCHEMA                                                                                                                \
    "CREATE TABLE IF NOT EXISTS outbox(seq INTEGER PRIMARY KEY AUTOINCREMENT, tag INTEGER NOT NULL, t INTEGER NOT NULL, v REAL,"           \
    " q INTEGER NOT NULL)"

struct month_outbox_row {
    int64_t seq, tag; /* seq: sequence number in the outbox; tag: the tag's id in the month's file */
    struct history_point point;
};
struct month_outbox_tag {
    int64_t id;
    char *name, *unit;
    bool step;
};
struct month_outbox_event {
    int64_t t_us;
    char *kind, *text;
};
/* The content of an outbox as read by one transaction; zero-initialise, free with month_outbox_batch_finish(). */
struct month_outbox_batch {
    /* rows: recorded points in order of insertion; held: each tag's newest sample that is not recorded yet */
    struct month_outbox_row *rows, *held;
    struct month_outbox_tag *tags;     /* list of all tags that the month's file contains, with their names and units */
    struct month_outbox_event *events; /* list of all events that the month's file contains, such as gaps in recording */
    size_t row_count, row_capacity, held_count, held_capacity, tag_count, tag_capacity, event_count, event_capacity;
};

struct month_outbox;
/* Opens the outbox of a month's file. Returns NULL with *error on failure; -ENOENT, not logged: there is no file, or it has no outbox. */
struct month_outbox *month_outbox_open(struct log *log, const char *folder, int month, int *error);
void month_outbox_close(struct month_outbox **outbox); /* Closes the outbox and sets *outbox to NULL; accepts a pointer to NULL. */
/* Sets *count to an estimate of the number of points in the outbox: the difference between the last and the first sequence number. */
int month_outbox_count(struct month_outbox *outbox, int64_t *count);
/* Finds the sequence number of the newest point; 0: the outbox is empty. */
int month_outbox_last(struct month_outbox *outbox, int64_t *seq);
/* Reads the oldest points of the outbox, at most `most`, as well as the file's newest samples, tags and events. Frees the
   batch's previous content. */
int month_outbox_read(struct month_outbox *outbox, size_t most, struct month_outbox_batch *batch);
void month_outbox_batch_finish(struct month_outbox_batch *batch);
/* Deletes the points with sequence numbers up to `seq`, because they have been sent. */
int month_outbox_delete(struct month_outbox *outbox, int64_t seq);
/* Deletes the oldest points of the outbox, sent or not, so that at most `keep` remain. */
int month_outbox_shorten(struct month_outbox *outbox, int64_t keep);

#endif
