/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The newest points of a month's file, in the order of recording: one compressed row per second, until month_file_tidy() moves
   the points to blocks. Rows are overwritten in place, because that writes fewer disk pages than deleting and inserting rows.
   Private to month_file*.c. Functions that return int return 0 or -errno, already logged. */
#ifndef HISTORY_MONTH_SECONDS_H
#define HISTORY_MONTH_SECONDS_H
#include "base/mem.h"
#include "history/month_file_impl.h"

struct month_row {
    int64_t id;   /* id of the row's tag in the month's file; 0: this element has no row */
    size_t order; /* position of the point in the order of recording; of two points with equal times the later one wins */
    struct history_point point;
};

/* The newest points, as read by a handle of a month's file from the table `second`. */
struct month_seconds {
    /* stamps increase with each write. mark: stamp in row 0 of the table; stamp, slot: stamp and number of the newest row read */
    int64_t mark, stamp, slot;
    struct month_row *rows; /* recorded points */
    /* [id of the tag in the file]: the tag's newest sample, which the recorder has not recorded yet (held); id 0: none */
    struct month_row *held;
    size_t count, capacity, held_count, held_capacity;
};

/* Writes recorded points and newest samples as one row of the table `second`, inside a transaction. Sorts the arrays. */
int month_seconds_write(struct month_file *file, struct month_row *rows, size_t count, struct month_row *held, size_t held_count);
/* Updates file->seconds from the current rows of the table `second`. */
int month_seconds_read(struct month_file *file);
/* Reads the mark: the stamp in row 0 of the table `second`. Points of rows with larger stamps are not in blocks yet. */
int month_seconds_mark(struct month_file *file, int64_t *mark);
/* Marks all rows that month_seconds_read() has read as moved to blocks. Must run inside the same transaction. Sets a mark that the
   table never had before, also if no row was read, so that other handles notice. */
int month_seconds_clear(struct month_file *file);
/* Frees the content of file->seconds. */
static inline void month_seconds_finish(struct month_file *file)
{
    if (file->seconds) {
        mem_free(file->seconds->rows);
        mem_free(file->seconds->held);
        *file->seconds = (struct month_seconds){ 0 };
    }
}

#endif
