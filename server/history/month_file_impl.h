/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State and functions shared by month_file*.c, month_blocks.c and month_seconds.c. Private to them. */
#ifndef HISTORY_MONTH_FILE_IMPL_H
#define HISTORY_MONTH_FILE_IMPL_H
#include <sys/types.h>

#include "base/files/database.h"
#include "history/month_file.h"

enum month_statement {
    SQL_BEGIN, SQL_BEGIN_READ, SQL_COMMIT, SQL_ROLLBACK, SQL_FIND_TAG, SQL_RENAME_TAG, SQL_TAG_UNIT, SQL_ADD_TAG,
    SQL_SET_STEP, SQL_HOLD, SQL_ADD_ROLLUP,
    SQL_ALL_HELD, SQL_CLEAR_HELD, SQL_CLEAR_ROLLUPS, SQL_NOTE,
    SQL_BEFORE, SQL_AFTER, SQL_RANGE, SQL_RECENT_OF, SQL_HELD_OF, SQL_ROLLUPS, SQL_NEWEST_ROLLUP, SQL_RECENT_ALL,
    SQL_WAITING, SQL_SPAN, SQL_EVENTS,
    SQL_HAS_BLOCKS, SQL_BLOCKS, SQL_NEXT_BLOCK, SQL_ADD_BLOCK, SQL_DELETE_BLOCK, SQL_BLOCK_SPAN, SQL_CUT_BLOCKS,
    SQL_CHUNK, SQL_ADD_CHUNK, SQL_CUT_CHUNKS, SQL_MARK, SQL_SET_MARK, SQL_SECONDS, SQL_ADD_SECOND, SQL_UPDATE_SECOND,
    SQL_ALL_TAGS, SQL_CUT_SAMPLES, SQL_CUT_ROLLUPS, SQL_CUT_EVENTS, SQL_SIZE, SQL_SHRINK, SQL_ADD_OUTBOX, SQL_HAS_OUTBOX, SQL_CUT_OUTBOX,
    SQL_FORGET_GAPS, SQL_FORGET_GAP_NOTES, SQL_FORGET_OUTBOX_GAPS,
    SQL_COUNT
};

struct month_rollups {
    bool loaded;
    struct rollup level[LEVEL_COUNT];
};

struct month_file {
    struct database db;
    int month;
    bool has_outbox; /* true: recorded points are copied to the outbox (points to send to PostgreSQL) */
    bool has_blocks; /* true: the file is known to have blocks of compressed points (format version 3 or later) */
    bool writes;     /* true: this handle has written to the table `second`, which holds the newest points (month_seconds.h) */
    ino_t inode;
    const struct plant *shown_by; /* plant to whose units values are converted; NULL: not converted */
    const struct history_tag *tags;
    size_t tag_count, waiting;
    int64_t *ids;                  /* [tag]: the tag's id in the file; 0: not known yet */
    struct month_rollups *rollups; /* [tag]: incomplete rollup buckets */
    /* the chunk (list of times shared by several blocks) that was read last, kept because other blocks share its times */
    struct month_chunk *chunk;
    struct month_seconds *seconds; /* newest points, not in blocks yet, as read by this handle from the table `second` */
    /* mark (stamp in row 0 of the table `second`) that this handle last wrote; 0: none yet. If the file has another mark, another
       handle has moved or changed points since then. */
    int64_t mark;
    /* number and stamp (increases with each write) of the last written row of the table `second` */
    int64_t slot, stamp;
    int64_t slot_before, stamp_before; /* `slot` and `stamp` at the start of the transaction, which end() restores after a rollback */
};

/* Returns the prepared SQL statement `which`, ready to bind and step (base/files/database.h). */
sqlite3_stmt *month_sql(struct month_file *file, enum month_statement which);
/* Runs an SQL statement to its end, and logs errors; `doing` tells the log what failed. Returns 0 or -errno. */
int month_run(struct month_file *file, sqlite3_stmt *statement, const char *doing);
/* Sets *has to true if the file now has an outbox (points to send to PostgreSQL); another handle may have created one. Returns
   0 or -errno. */
int month_has_outbox(struct month_file *file, bool *has);
struct history_point month_point(sqlite3_stmt *statement, int first_column); /* Reads a point from three consecutive columns t, v, q
                                                                                of the current row, beginning with first_column. */
/* Returns true if the file has the tables `block` and `second`; files of versions 1 and 2 lack them until a writer upgrades the file. */
bool month_has_blocks(struct month_file *file);
/* Returns the id of the tag's series whose unit is, or can be converted to, `wanted`, and sets *change to the conversion; 0:
   the file has no such series. wanted NULL: returns the series with the newest points, without conversion. */
int64_t month_find_tag(struct month_file *file, const char *name, const char *wanted, bool *step, struct unit_change *change);
/* Appends the points of a tag, oldest first, from the compressed blocks and from the table `sample` (older versions of the
   file): from the last point at or before from_us to the first one after to_us. Returns 0 or -errno. */
int month_stored_points(struct month_file *file, int64_t id, int64_t from_us, int64_t to_us, struct history_points *out);
void history_points_add(struct history_points *points, const struct history_point *point);

#endif
