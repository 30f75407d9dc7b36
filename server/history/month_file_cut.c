/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Deletes the oldest points of a month's file. */
#include "history/month.h"
#include "history/month_blocks.h"

int month_file_size(struct month_file *file, struct month_file_size *size)
{
    sqlite3_stmt *statement = month_sql(file, SQL_SIZE);
    int code = database_step(&file->db, statement);
    if (code == SQLITE_ROW) {
        int64_t page = sqlite3_column_int64(statement, 0);
        size->bytes = page * sqlite3_column_int64(statement, 1);
        size->free_bytes = page * sqlite3_column_int64(statement, 2);
        size->shrinks = sqlite3_column_int(statement, 3) != 0;
    }
    sqlite3_reset(statement);
    return database_fail(&file->db, code, "cannot determine the size of the history file");
}

static bool remove_before(void *arg, struct history_points *points)
{
    const int64_t *until_us = arg;
    size_t kept = 0, before = points->count;
    for (size_t i = 0; i < before; i++)
        if (points->at[i].t_us >= *until_us)
            points->at[kept++] = points->at[i];
    points->count = kept;
    return kept < before;
}

static int cut_tag(struct month_file *file, int64_t id, int64_t until_us)
{
    sqlite3_stmt *samples = month_sql(file, SQL_CUT_SAMPLES);
    sqlite3_bind_int64(samples, 1, id);
    sqlite3_bind_int64(samples, 2, until_us);
    int error = month_run(file, samples, "cannot delete samples");
    sqlite3_stmt *blocks = month_sql(file, SQL_CUT_BLOCKS);
    sqlite3_bind_int64(blocks, 1, id);
    sqlite3_bind_int64(blocks, 2, until_us);
    if (!error)
        error = month_run(file, blocks, "cannot delete old points from the history file");
    if (!error)
        error = month_blocks_edit(file, id, until_us - 1, until_us - 1, remove_before, &until_us);
    for (int level = 0; level < LEVEL_COUNT && !error; level++) {
        sqlite3_stmt *rollups = month_sql(file, SQL_CUT_ROLLUPS);
        sqlite3_bind_int64(rollups, 1, id);
        sqlite3_bind_int64(rollups, 2, history_level_us[level] / US_PER_S);
        sqlite3_bind_int64(rollups, 3, until_us - history_level_us[level]);
        error = month_run(file, rollups, "cannot delete rollups");
    }
    return error;
}

static int cut_tags(struct month_file *file, int64_t until_us)
{
    sqlite3_stmt *tags = month_sql(file, SQL_ALL_TAGS), *events = month_sql(file, SQL_CUT_EVENTS);
    sqlite3_stmt *chunks = month_sql(file, SQL_CUT_CHUNKS);
    int code = SQLITE_DONE, error = 0;
    while (!error && (code = database_step(&file->db, tags)) == SQLITE_ROW)
        error = cut_tag(file, sqlite3_column_int64(tags, 0), until_us);
    sqlite3_reset(tags);
    if (!error)
        error = database_fail(&file->db, code, "cannot read tags");
    sqlite3_bind_int64(chunks, 1, until_us);
    if (!error)
        error = month_run(file, chunks, "cannot delete the times of old points from the history file");
    sqlite3_bind_int64(events, 1, until_us);
    return error ? error : month_run(file, events, "cannot delete events");
}

static int cut_outbox(struct month_file *file, int64_t until_us, int64_t *unsent)
{
    bool has = false;
    int error = month_has_outbox(file, &has);
    if (error || !has)
        return error;
    sqlite3_stmt *cut = month_sql(file, SQL_CUT_OUTBOX);
    sqlite3_bind_int64(cut, 1, until_us);
    error = month_run(file, cut, "cannot delete old points that were not sent to PostgreSQL");
    *unsent += error ? 0 : sqlite3_changes(file->db.handle);
    return error;
}

int month_file_cut(struct month_file *file, int64_t until_us, bool shrink, int64_t *unsent)
{
    int64_t cut = 0;
    int error = month_run(file, month_sql(file, SQL_BEGIN), "cannot begin a transaction");
    if (error)
        return error;
    error = cut_tags(file, until_us);
    if (!error)
        error = cut_outbox(file, until_us, &cut);
    if (!error)
        error = month_run(file, month_sql(file, SQL_COMMIT), "cannot commit a transaction");
    if (!sqlite3_get_autocommit(file->db.handle))
        database_run(&file->db, month_sql(file, SQL_ROLLBACK));
    *unsent += error ? 0 : cut;
    return error || !shrink ? error : month_run(file, month_sql(file, SQL_SHRINK), "cannot be shrunk");
}
