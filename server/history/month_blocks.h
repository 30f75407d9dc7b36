/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Blocks of a month's file: each holds up to BLOCK_POINTS points of one tag, compressed. Blocks of one tag do not overlap in
   time. Blocks written together share one list of times, which is a row of the table `chunk`. Private to month_file*.c.
   Functions that return int return 0 or -errno, already logged; those that write must run inside a transaction. */
#ifndef HISTORY_MONTH_BLOCKS_H
#define HISTORY_MONTH_BLOCKS_H
#include "history/month_file_impl.h"

/* A chunk: ascending times shared by several blocks, because many tags have points at the same times. id 0: each block stores
   its own times. */
struct month_chunk {
    int64_t id, *times;
    size_t count;
};

/* Appends the points of a tag, oldest first: from the last one at or before from_us to the first one after to_us. */
int month_blocks_read(struct month_file *file, int64_t id, int64_t from_us, int64_t to_us, struct history_points *out);
/* Stores a chunk's ascending times in the file and sets the chunk's id. The id becomes 0 if there are too many times for one
   chunk; each block then stores its own times. */
int month_chunk_store(struct month_file *file, struct month_chunk *chunk);
/* Writes ascending points of a tag as blocks. If the chunk has an id, it must contain the times of these points. Merges the
   points with those of existing blocks in that time span; a new point replaces an old one of the same time. */
int month_blocks_write(struct month_file *file, int64_t id, const struct month_chunk *chunk, const struct history_point *points,
                       size_t count);
/* Calls `edit` with the points of each block of a tag that overlaps from_us..to_us, and rewrites the block if `edit` returned true. */
typedef bool month_block_edit(void *arg, struct history_points *points);
int month_blocks_edit(struct month_file *file, int64_t id, int64_t from_us, int64_t to_us, month_block_edit *edit, void *arg);
/* Merges two ascending lists into `out`. If both have a point at the same time, that of `b` wins. */
void month_points_merge(const struct history_points *a, const struct history_points *b, struct history_points *out);

#endif
