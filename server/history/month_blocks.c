/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and writes the blocks of a month's file. A block holds compressed points of one tag. */
#include "history/month_blocks.h"

#include <errno.h>
#include <string.h>

#include "base/mem.h"
#include "history/columns.h"

/* SHARED_TIMES: maximum number of times in a chunk (a list of times shared by several blocks). It is limited because reading
   one block means decompressing all times of its chunk. */
enum { BLOCK_POINTS = 2048, SHARED_TIMES = 32768, BLOCK_COLUMNS = 3 };

static int damaged(struct month_file *file)
{
    log_err(file->db.log, "%s: this history file is damaged: a block of recorded points cannot be decompressed", file->db.path);
    return -EBADMSG;
}

/* --- times that blocks share -------------------------------------------------------------------------------------------------- */

int month_chunk_store(struct month_file *file, struct month_chunk *chunk)
{
    chunk->id = 0;
    if (chunk->count == 0 || chunk->count > SHARED_TIMES)
        return 0;
    uint64_t *rows = mem_array(chunk->count, sizeof(*rows)), last = 0;
    for (size_t i = 0; i < chunk->count; i++) {
        rows[i] = (uint64_t)chunk->times[i] - last;
        last = (uint64_t)chunk->times[i];
    }
    size_t bytes;
    uint8_t *packed = columns_pack(rows, 1, chunk->count, &bytes);
    sqlite3_stmt *add = month_sql(file, SQL_ADD_CHUNK);
    sqlite3_bind_int64(add, 1, chunk->times[chunk->count - 1]);
    sqlite3_bind_blob(add, 2, packed, (int)bytes, SQLITE_STATIC);
    int error = month_run(file, add, "cannot write the times of recorded points");
    chunk->id = error ? 0 : sqlite3_last_insert_rowid(file->db.handle);
    mem_free(packed);
    mem_free(rows);
    return error;
}

/* Loads a chunk (times shared by several blocks) into file->chunk, for the blocks that are read next. */
static int load_chunk(struct month_file *file, int64_t id)
{
    if (id == file->chunk->id)
        return 0;
    sqlite3_stmt *find = month_sql(file, SQL_CHUNK);
    sqlite3_bind_int64(find, 1, id);
    int code = database_step(&file->db, find), error = database_fail(&file->db, code, "cannot read the times of recorded points");
    mem_free(file->chunk->times);
    *file->chunk = (struct month_chunk){ 0 };
    if (code == SQLITE_ROW)
        file->chunk->times =
            (int64_t *)columns_unpack(sqlite3_column_blob(find, 0), (size_t)sqlite3_column_bytes(find, 0), 1, &file->chunk->count);
    sqlite3_reset(find);
    if (error || !file->chunk->times)
        return error ? error : damaged(file);
    for (size_t i = 1; i < file->chunk->count; i++)
        file->chunk->times[i] = (int64_t)((uint64_t)file->chunk->times[i] + (uint64_t)file->chunk->times[i - 1]);
    file->chunk->id = id;
    return 0;
}

/* Returns the index of a time in a chunk (sorted times shared by several blocks), searching from `from` on. */
static uint64_t index_of(const struct month_chunk *chunk, size_t from, int64_t t_us)
{
    size_t low = from, high = chunk->count;
    while (low + 1 < high) {
        size_t middle = (low + high) / 2;
        if (chunk->times[middle] <= t_us)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* --- one block ---------------------------------------------------------------------------------------------------------------- */

static int put_block(struct month_file *file, int64_t id, const struct month_chunk *chunk, const struct history_point *points, size_t count)
{
    uint64_t *rows = mem_array(count * BLOCK_COLUMNS, sizeof(*rows)), last[BLOCK_COLUMNS] = { 0 };
    for (size_t i = 0; i < count; i++) {
        uint64_t now[] = { chunk->id ? index_of(chunk, (size_t)last[0], points[i].t_us) : (uint64_t)points[i].t_us,
                           columns_of_double(points[i].value), points[i].quality };
        rows[i * BLOCK_COLUMNS] = now[0] - last[0];
        rows[i * BLOCK_COLUMNS + 1] = now[1] ^ last[1];
        rows[i * BLOCK_COLUMNS + 2] = now[2] ^ last[2];
        memcpy(last, now, sizeof(last));
    }
    size_t bytes;
    uint8_t *packed = columns_pack(rows, BLOCK_COLUMNS, count, &bytes);
    sqlite3_stmt *add = month_sql(file, SQL_ADD_BLOCK);
    sqlite3_bind_int64(add, 1, id);
    sqlite3_bind_int64(add, 2, points[0].t_us);
    sqlite3_bind_int64(add, 3, points[count - 1].t_us);
    sqlite3_bind_int64(add, 4, chunk->id);
    sqlite3_bind_blob(add, 5, packed, (int)bytes, SQLITE_STATIC);
    int error = month_run(file, add, "cannot write points");
    mem_free(packed);
    mem_free(rows);
    return error;
}

static int put_blocks(struct month_file *file, int64_t id, const struct month_chunk *chunk, const struct history_point *points,
                      size_t count)
{
    int error = 0;
    for (size_t i = 0; i < count && !error; i += BLOCK_POINTS)
        error = put_block(file, id, chunk, points + i, count - i < BLOCK_POINTS ? count - i : BLOCK_POINTS);
    return error;
}

static bool add_rows(const struct month_chunk *chunk, bool shared, const uint64_t *rows, size_t count, struct history_points *out)
{
    uint64_t at = 0, bits = 0, quality = 0;
    mem_grow(&out->at, &out->capacity, out->count + count, sizeof(*out->at));
    for (size_t i = 0; i < count; i++) {
        at += rows[i * BLOCK_COLUMNS];
        bits ^= rows[i * BLOCK_COLUMNS + 1];
        quality ^= rows[i * BLOCK_COLUMNS + 2];
        if (shared && at >= chunk->count)
            return false;
        out->at[out->count++] =
            (struct history_point){ shared ? chunk->times[at] : (int64_t)at, columns_to_double(bits), (uint32_t)quality };
    }
    return true;
}

/* Decodes the block in the current row of an SQL query and appends its points to `out`. Column 0: id of the block's chunk
   (shared times); column 1: the compressed data. */
static int take_block(struct month_file *file, sqlite3_stmt *block, struct history_points *out)
{
    int64_t chunk = sqlite3_column_int64(block, 0);
    int error = chunk ? load_chunk(file, chunk) : 0;
    size_t count;
    uint64_t *rows =
        error ? NULL : columns_unpack(sqlite3_column_blob(block, 1), (size_t)sqlite3_column_bytes(block, 1), BLOCK_COLUMNS, &count);
    if (!error && (!rows || !count || !add_rows(file->chunk, chunk != 0, rows, count, out)))
        error = damaged(file);
    mem_free(rows);
    return error;
}

static int delete_block(struct month_file *file, int64_t id, int64_t t_us)
{
    sqlite3_stmt *delete = month_sql(file, SQL_DELETE_BLOCK);
    sqlite3_bind_int64(delete, 1, id);
    sqlite3_bind_int64(delete, 2, t_us);
    return month_run(file, delete, "cannot delete points");
}

/* --- the blocks of a tag ------------------------------------------------------------------------------------------------------ */

/* Returns true if `points`, as a result of a query from from_us on, holds more points than its maximum, so that reading can
   stop. */
static bool exceeds(const struct history_points *points, int64_t from_us)
{
    return history_points_full(points) && points->at[points->count - 1 - points->max].t_us > from_us;
}

int month_blocks_read(struct month_file *file, int64_t id, int64_t from_us, int64_t to_us, struct history_points *out)
{
    if (!month_has_blocks(file))
        return 0;
    sqlite3_stmt *blocks = month_sql(file, SQL_BLOCKS);
    int code, error = 0;
    sqlite3_bind_int64(blocks, 1, id);
    sqlite3_bind_int64(blocks, 2, from_us);
    while ((code = database_step(&file->db, blocks)) == SQLITE_ROW && !(error = take_block(file, blocks, out)))
        if (out->at[out->count - 1].t_us > to_us || exceeds(out, from_us))
            break;
    sqlite3_reset(blocks);
    return error ? error : database_fail(&file->db, code, "cannot be read");
}

int month_blocks_edit(struct month_file *file, int64_t id, int64_t from_us, int64_t to_us, month_block_edit *edit, void *arg)
{
    static const struct month_chunk own = { 0 };
    struct history_points points = { 0 };
    int64_t t_us = INT64_MIN;
    int error = 0;
    for (bool more = true; more && !error;) {
        sqlite3_stmt *next = month_sql(file, SQL_NEXT_BLOCK);
        sqlite3_bind_int64(next, 1, id);
        sqlite3_bind_int64(next, 2, t_us);
        sqlite3_bind_int64(next, 3, to_us);
        sqlite3_bind_int64(next, 4, from_us);
        int code = database_step(&file->db, next);
        points.count = 0;
        more = code == SQLITE_ROW;
        error = more ? take_block(file, next, &points) : database_fail(&file->db, code, "cannot be read");
        t_us = more ? sqlite3_column_int64(next, 2) : 0;
        sqlite3_reset(next);
        if (more && !error && edit(arg, &points) && !(error = delete_block(file, id, t_us)))
            error = put_blocks(file, id, &own, points.at, points.count);
    }
    mem_free(points.at);
    return error;
}

void month_points_merge(const struct history_points *a, const struct history_points *b, struct history_points *out)
{
    size_t i = 0, j = 0, begin = out->count;
    mem_grow(&out->at, &out->capacity, begin + a->count + b->count + 1, sizeof(*out->at));
    while (i < a->count || j < b->count) {
        bool first = j == b->count || (i < a->count && a->at[i].t_us <= b->at[j].t_us);
        const struct history_point *next = first ? &a->at[i++] : &b->at[j++];
        if (out->count > begin && out->at[out->count - 1].t_us == next->t_us)
            out->count--;
        out->at[out->count++] = *next;
    }
}

static bool move_all(void *arg, struct history_points *points)
{
    struct history_points *to = arg;
    for (size_t i = 0; i < points->count; i++)
        history_points_add(to, &points->at[i]);
    points->count = 0;
    return true;
}

int month_blocks_write(struct month_file *file, int64_t id, const struct month_chunk *chunk, const struct history_point *points,
                       size_t count)
{
    static const struct month_chunk own = { 0 };
    struct history_points stored = { 0 }, merged = { 0 };
    const struct history_points fresh = { .at = (struct history_point *)points, .count = count };
    if (!count)
        return 0;
    int error = month_blocks_edit(file, id, points[0].t_us, points[count - 1].t_us, move_all, &stored);
    if (!error) {
        month_points_merge(&stored, &fresh, &merged);
        error = put_blocks(file, id, stored.count ? &own : chunk, merged.at, merged.count);
    }
    mem_free(stored.at);
    mem_free(merged.at);
    return error;
}
