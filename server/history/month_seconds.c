/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and writes the table `second` of a month's file: one row per recorded second, with the compressed points of that second. */
#include "history/month_seconds.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "history/columns.h"

/* SQLite overwrites a row in place only if its size stays the same. Rows are therefore padded to ROW_BYTES, which fills a page
   of 1024 bytes, plus a multiple of PAGE_BYTES, one for each further page that the data needs. */
enum { SECOND_COLUMNS = 4, ROW_BYTES = 930, PAGE_BYTES = 1020, ID_MAX = 1 << 22 };

/* --- writing ------------------------------------------------------------------------------------------------------------------ */

int month_seconds_mark(struct month_file *file, int64_t *mark)
{
    sqlite3_stmt *find = month_sql(file, SQL_MARK);
    int code = database_step(&file->db, find);
    if (code == SQLITE_ROW)
        *mark = sqlite3_column_int64(find, 0);
    sqlite3_reset(find);
    return database_fail(&file->db, code, "cannot be read");
}

/* Compares points (rows) by time, then by tag: in this order, the differences between successive points are small and compress
   well. */
static int by_time_and_tag(const void *a, const void *b)
{
    const struct month_row *x = a, *y = b;
    if (x->point.t_us != y->point.t_us)
        return x->point.t_us < y->point.t_us ? -1 : 1;
    if (x->id != y->id)
        return x->id < y->id ? -1 : 1;
    return x->order < y->order ? -1 : x->order > y->order;
}

/* Sorts the points (rows) of a second and writes each to `at` as four numbers: tag (with one bit for recorded or held), time,
   value, quality. Returns the end of the written numbers. */
static uint64_t *put_rows(uint64_t *at, struct month_row *rows, size_t count, bool held)
{
    uint64_t last_tag = 0, last_t = 0;
    for (size_t i = 0; i < count; i++)
        rows[i].order = i;
    if (count)
        qsort(rows, count, sizeof(*rows), by_time_and_tag);
    for (size_t i = 0; i < count; i++, at += SECOND_COLUMNS) {
        at[0] = ((uint64_t)rows[i].id - last_tag) << 1 | held;
        at[1] = (uint64_t)rows[i].point.t_us - last_t;
        at[2] = columns_of_double(rows[i].point.value);
        at[3] = rows[i].point.quality;
        last_tag = (uint64_t)rows[i].id;
        last_t = (uint64_t)rows[i].point.t_us;
    }
    return at;
}

static int update_row(struct month_file *file, enum month_statement which, int64_t stamp, const uint8_t *data, size_t bytes)
{
    sqlite3_stmt *row = month_sql(file, which);
    sqlite3_bind_int64(row, 1, file->slot);
    sqlite3_bind_int64(row, 2, stamp);
    sqlite3_bind_blob(row, 3, data, (int)bytes, SQLITE_STATIC);
    return month_run(file, row, "cannot write the recorded points of a second");
}

int month_seconds_write(struct month_file *file, struct month_row *rows, size_t count, struct month_row *held, size_t held_count)
{
    int64_t mark = 0;
    int error = month_seconds_mark(file, &mark);
    if (error || count + held_count == 0)
        return error;
    /* All rows of the table `second` are free, because their points were moved to blocks, perhaps through another handle. So
       writing restarts at the table's first row. */
    if (mark >= file->stamp) {
        file->stamp = mark;
        file->slot = 0;
    }
    uint64_t *packed = mem_array((count + held_count) * SECOND_COLUMNS, sizeof(*packed)), *at = put_rows(packed, rows, count, false);
    put_rows(at, held, held_count, true);
    size_t bytes;
    uint8_t *data = columns_pack(packed, SECOND_COLUMNS, count + held_count, &bytes), *padded;
    size_t pages = bytes <= ROW_BYTES ? 0 : (bytes - ROW_BYTES + PAGE_BYTES - 1) / PAGE_BYTES, size = ROW_BYTES + pages * PAGE_BYTES;
    padded = mem_array(size, 1);
    memcpy(padded, data, bytes);
    file->slot++;
    file->stamp++;
    error = update_row(file, SQL_UPDATE_SECOND, file->stamp, padded, size);
    if (!error && sqlite3_changes(file->db.handle) == 0)
        error = update_row(file, SQL_ADD_SECOND, file->stamp, padded, size);
    mem_free(padded);
    mem_free(data);
    mem_free(packed);
    return error;
}

int month_seconds_clear(struct month_file *file)
{
    sqlite3_stmt *mark = month_sql(file, SQL_SET_MARK);
    file->mark = file->seconds->stamp + 1;
    sqlite3_bind_int64(mark, 1, file->mark);
    return month_run(file, mark, "cannot mark the table `second` of the history file as empty");
}

/* --- reading ------------------------------------------------------------------------------------------------------------------ */

static void add_held(struct month_seconds *seconds, const struct month_row *row)
{
    mem_grow(&seconds->held, &seconds->held_capacity, (size_t)row->id + 1, sizeof(*seconds->held));
    while (seconds->held_count <= (size_t)row->id)
        seconds->held[seconds->held_count++] = (struct month_row){ 0 };
    seconds->held[row->id] = *row;
}

static void add_rows(struct month_seconds *seconds, const uint64_t *packed, size_t count)
{
    /* tag and time of the previous row; index 0: among recorded points, index 1: among held ones (newest samples, not recorded
       yet) */
    uint64_t tag[2] = { 0 }, t[2] = { 0 };
    mem_grow(&seconds->rows, &seconds->capacity, seconds->count + count + 1, sizeof(*seconds->rows));
    for (const uint64_t *at = packed; at < packed + count * SECOND_COLUMNS; at += SECOND_COLUMNS) {
        bool held = at[0] & 1;
        tag[held] += (uint64_t)((int64_t)at[0] >> 1);
        t[held] += at[1];
        struct month_row row = { (int64_t)tag[held], seconds->count, { (int64_t)t[held], columns_to_double(at[2]), (uint32_t)at[3] } };
        if (row.id < 1 || row.id > ID_MAX)
            continue; /* skip a damaged row */
        if (held)
            add_held(seconds, &row);
        else
            seconds->rows[seconds->count++] = row;
    }
}

static int take_second(struct month_file *file, sqlite3_stmt *second)
{
    size_t count;
    uint64_t *rows =
        columns_unpack(sqlite3_column_blob(second, 2), (size_t)sqlite3_column_bytes(second, 2), SECOND_COLUMNS, &count);
    file->seconds->slot = sqlite3_column_int64(second, 0);
    file->seconds->stamp = sqlite3_column_int64(second, 1);
    if (!rows) {
        log_err(file->db.log, "%s: this history file is damaged: the recorded points of a second cannot be decompressed", file->db.path);
        return -EBADMSG;
    }
    add_rows(file->seconds, rows, count);
    mem_free(rows);
    return 0;
}

int month_seconds_read(struct month_file *file)
{
    struct month_seconds *seconds = file->seconds;
    int64_t mark = 0;
    if (!month_has_blocks(file))
        return 0;
    int code, error = month_seconds_mark(file, &mark);
    if (error)
        return error;
    if (mark != seconds->mark) {
        seconds->mark = seconds->stamp = mark;
        seconds->slot = 0;
        seconds->count = seconds->held_count = 0;
    }
    sqlite3_stmt *next = month_sql(file, SQL_SECONDS);
    sqlite3_bind_int64(next, 1, seconds->slot);
    while ((code = database_step(&file->db, next)) == SQLITE_ROW && !error) {
        if (sqlite3_column_int64(next, 1) <= seconds->stamp)
            /* stops here: rows of the table `second` are overwritten in order, so this row and all that follow are older, and
               their points are already in blocks */
            break;
        error = take_second(file, next);
    }
    sqlite3_reset(next);
    return error ? error : database_fail(&file->db, code, "cannot be read");
}
