/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes a month's file. Rows are first written in order of time; later they are sorted by tag and reduced to rollups. */
#include <errno.h>
#include <string.h>

#include "base/mem.h"
#include "history/month.h"
#include "history/month_file_impl.h"
#include "history/month_outbox.h"

/* --- transactions ------------------------------------------------------------------------------------------------------------- */

static int begin(struct month_file *file)
{
    return month_run(file, month_sql(file, SQL_BEGIN), "cannot begin to write");
}

/* Commits the transaction if `error` is 0, otherwise rolls it back. After a rollback, tag ids and rollups in memory differ from the
   file, so they are reset. */
static int end(struct month_file *file, int error)
{
    if (!error)
        error = month_run(file, month_sql(file, SQL_COMMIT), "cannot commit");
    if (!error)
        return 0;
    if (!sqlite3_get_autocommit(file->db.handle))
        database_run(&file->db, month_sql(file, SQL_ROLLBACK));
    memset(file->rollups, 0, file->tag_count * sizeof(*file->rollups));
    memset(file->ids, 0, file->tag_count * sizeof(*file->ids));
    return error;
}

/* Converts all values of a tag in this file to the unit in which the plant shows the tag now, if that is not the file's unit. */
static int convert_unit(struct month_file *file, const struct history_tag *of)
{
    sqlite3_stmt *find = month_sql(file, SQL_FIND_TAG);
    struct unit_change change = { 0 };
    int64_t id = 0;
    database_bind_text(find, 1, of->name);
    if (database_step(&file->db, find) == SQLITE_ROW) {
        id = sqlite3_column_int64(find, 0);
        units_compare(database_text(find, 2), of->unit, &change);
    }
    sqlite3_reset(find);
    if (!change.converts)
        return 0;
    static const char *const columns[][2] = { { "sample", "v" },     { "recent", "v" },    { "held", "v" },
                                              { "rollup", "low" },   { "rollup", "high" }, { "rollup", "mean" },
                                              { "rollup", "first" }, { "rollup", "last" }, { "outbox", "v" } };
    bool has_outbox; /* true: uses an outbox, which may exist because an earlier run had a database configured; none is created */
    int error = month_has_outbox(file, &has_outbox);
    size_t count = sizeof(columns) / sizeof(columns[0]) - !has_outbox;
    for (size_t i = 0; i < count && !error; i++) {
        char *sql = mem_printf("UPDATE %s SET %s = %s * %.17g + %.17g WHERE tag = %lld", columns[i][0], columns[i][1], columns[i][1],
                               change.factor, change.offset, (long long)id);
        error = database_exec(&file->db, sql, "cannot convert units");
        mem_free(sql);
    }
    return error;
}

static int tag_id(struct month_file *file, int tag, int64_t *id)
{
    const struct history_tag *of = &file->tags[tag];
    *id = file->ids[tag];
    if (*id)
        return 0;
    int unit_error = convert_unit(file, of);
    if (unit_error)
        return unit_error;
    sqlite3_stmt *add = month_sql(file, SQL_ADD_TAG);
    database_bind_text(add, 1, of->name);
    database_bind_text(add, 2, of->unit);
    sqlite3_bind_int(add, 3, of->step);
    sqlite3_bind_double(add, 4, of->within);
    int code = database_step(&file->db, add);
    if (code == SQLITE_ROW)
        file->ids[tag] = *id = sqlite3_column_int64(add, 0);
    int error = database_fail(&file->db, code, "cannot add a tag");
    sqlite3_reset(add);
    return error;
}

static int put(struct month_file *file, enum month_statement which, int64_t id, const struct history_point *point)
{
    sqlite3_stmt *statement = month_sql(file, which);
    sqlite3_bind_int64(statement, 1, id);
    sqlite3_bind_int64(statement, 2, point->t_us);
    database_bind_value(statement, 3, point->value);
    sqlite3_bind_int64(statement, 4, point->quality);
    return month_run(file, statement, "cannot write");
}

/* Writes a new point to the table and to the outbox. To move an existing point, call put(), which writes to the table alone. */
static int record(struct month_file *file, enum month_statement which, int64_t id, const struct history_point *point)
{
    int error = put(file, which, id, point);
    return error || !file->has_outbox || which == SQL_HOLD ? error : put(file, SQL_ADD_OUTBOX, id, point);
}

static int put_rows(struct month_file *file, enum month_statement which, const struct history_row *rows, size_t count)
{
    int error = 0;
    for (size_t i = 0; i < count && !error; i++) {
        int64_t id;
        error = tag_id(file, rows[i].tag, &id);
        if (!error)
            error = record(file, which, id, &rows[i].point);
    }
    return error;
}

int month_file_write(struct month_file *file, const struct history_row *rows, size_t count, const struct history_row *held,
                     size_t held_count)
{
    int error = begin(file);
    if (error)
        return error;
    error = put_rows(file, SQL_ADD_RECENT, rows, count);
    if (!error)
        error = put_rows(file, SQL_HOLD, held, held_count);
    error = end(file, error);
    if (!error)
        file->waiting += count;
    return error;
}

int month_file_use_outbox(struct month_file *file)
{
    int error = database_exec(&file->db, MONTH_OUTBOX_SCHEMA, "cannot be given an outbox");
    file->has_outbox = !error;
    return error;
}

int month_file_note(struct month_file *file, int64_t t_us, const char *kind, const char *text)
{
    sqlite3_stmt *note = month_sql(file, SQL_NOTE);
    sqlite3_bind_int64(note, 1, t_us);
    database_bind_text(note, 2, kind);
    database_bind_text(note, 3, text);
    return month_run(file, note, "cannot note an event");
}

/* --- rolling up --------------------------------------------------------------------------------------------------------------- */

static int put_bucket(struct month_file *file, int64_t id, int64_t length_us, const struct history_bucket *bucket)
{
    sqlite3_stmt *add = month_sql(file, SQL_ADD_ROLLUP);
    sqlite3_bind_int64(add, 1, length_us / US_PER_S);
    sqlite3_bind_int64(add, 2, id);
    sqlite3_bind_int64(add, 3, bucket->t_us);
    database_bind_value(add, 4, bucket->low);
    database_bind_value(add, 5, bucket->high);
    database_bind_value(add, 6, bucket->mean);
    database_bind_value(add, 7, bucket->first);
    database_bind_value(add, 8, bucket->last);
    sqlite3_bind_int64(add, 9, bucket->good_us);
    sqlite3_bind_int64(add, 10, bucket->bad_us);
    sqlite3_bind_int64(add, 11, bucket->quality);
    return month_run(file, add, "cannot roll up");
}

static void reset_rollups(struct month_rollups *rollups, bool step)
{
    *rollups = (struct month_rollups){ .loaded = true };
    for (int level = 0; level < LEVEL_COUNT; level++)
        rollups->level[level] = (struct rollup){ .length_us = history_level_us[level], .step = step };
}

void month_file_forget_rollups(struct month_file *file)
{
    memset(file->rollups, 0, file->tag_count * sizeof(*file->rollups));
}

/* Computes the rollups from the samples that follow the beginning of from_us's hour, and from the last sample before it. Writes the
   buckets to disk if `store`. */
static int roll_from(struct month_file *file, int64_t id, int64_t from_us, struct month_rollups *rollups, bool store)
{
    sqlite3_stmt *samples = month_sql(file, SQL_SAMPLES_FROM);
    int64_t hour_us = from_us - from_us % history_level_us[LEVEL_1_H];
    int code, error = 0;
    sqlite3_bind_int64(samples, 1, id);
    sqlite3_bind_int64(samples, 2, hour_us);
    while (!error && (code = database_step(&file->db, samples)) == SQLITE_ROW) {
        struct history_point point = month_point(samples, 0);
        struct history_bucket closed;
        for (int level = 0; level < LEVEL_COUNT && !error; level++)
            if (rollup_put(&rollups->level[level], &point, &closed) && store && closed.t_us >= hour_us)
                error = put_bucket(file, id, history_level_us[level], &closed);
    }
    sqlite3_reset(samples);
    return error ? error : database_fail(&file->db, code, "cannot read samples");
}

/* Restores the incomplete rollup buckets in memory from the samples that the previous writer left in the file. */
static int load_rollups(struct month_file *file, int tag, int64_t id)
{
    struct month_rollups *rollups = &file->rollups[tag];
    reset_rollups(rollups, file->tags[tag].step);
    sqlite3_stmt *last = month_sql(file, SQL_LAST_SAMPLE);
    sqlite3_bind_int64(last, 1, id);
    int code = database_step(&file->db, last);
    int64_t t_us = code == SQLITE_ROW ? sqlite3_column_int64(last, 0) : INT64_MIN;
    sqlite3_reset(last);
    int error = database_fail(&file->db, code, "cannot read samples");
    return error || t_us == INT64_MIN ? error : roll_from(file, id, t_us, rollups, false);
}

static int roll_point(struct month_file *file, int tag, int64_t id, const struct history_point *point)
{
    struct month_rollups *rollups = &file->rollups[tag];
    struct history_bucket closed;
    int error = 0;
    for (int level = 0; level < LEVEL_COUNT && !error; level++)
        if (rollup_put(&rollups->level[level], point, &closed))
            error = put_bucket(file, id, history_level_us[level], &closed);
    return error;
}

/* --- moving recent points to the table of samples ----------------------------------------------------------------------------- */

static int *tags_by_id(const struct month_file *file, int64_t *most)
{
    *most = 0;
    for (size_t i = 0; i < file->tag_count; i++)
        if (file->ids[i] > *most)
            *most = file->ids[i];
    int *tags = mem_array((size_t)*most + 1, sizeof(*tags));
    memset(tags, 0xff, ((size_t)*most + 1) * sizeof(*tags));
    for (size_t i = 0; i < file->tag_count; i++)
        if (file->ids[i])
            tags[file->ids[i]] = (int)i;
    return tags;
}

static int move_row(struct month_file *file, int tag, int64_t id, const struct history_point *point)
{
    int error = 0;
    if (tag >= 0 && !file->rollups[tag].loaded)
        error = load_rollups(file, tag, id); /* the rollups must be loaded before the new sample is in the table */
    if (!error)
        error = put(file, SQL_ADD_SAMPLE, id, point);
    return error || tag < 0 ? error : roll_point(file, tag, id, point);
}

static int move_rows(struct month_file *file)
{
    int64_t most;
    int code, error = 0, *tags = tags_by_id(file, &most);
    sqlite3_stmt *recent = month_sql(file, SQL_RECENT);
    while (!error && (code = database_step(&file->db, recent)) == SQLITE_ROW) {
        int64_t id = sqlite3_column_int64(recent, 0);
        struct history_point point = month_point(recent, 1);
        error = move_row(file, id <= most ? tags[id] : -1, id, &point);
    }
    sqlite3_reset(recent);
    mem_free(tags);
    return error ? error : database_fail(&file->db, code, "cannot read recent points");
}

int month_file_tidy(struct month_file *file)
{
    if (!file->waiting)
        return 0;
    int error = begin(file);
    if (error)
        return error;
    for (size_t i = 0; i < file->tag_count && !error; i++) {
        int64_t id;
        error = tag_id(file, (int)i, &id);
    }
    if (!error)
        error = move_rows(file);
    if (!error)
        error = month_run(file, month_sql(file, SQL_CLEAR_RECENT), "cannot clear recent points");
    error = end(file, error);
    if (!error)
        file->waiting = 0;
    return error;
}

/* --- imports and recovery ----------------------------------------------------------------------------------------------------- */

static int roll_again(struct month_file *file, int tag, int64_t id, int64_t from_us)
{
    struct month_rollups rollups;
    struct history_point before;
    int error = month_one_point(file, SQL_BEFORE, id, from_us - 1, &before);
    if (before.t_us != INT64_MIN) /* the line of the point before from_us now ends at a new point, so its buckets change too */
        from_us = before.t_us;
    from_us -= from_us % history_level_us[LEVEL_1_H];
    for (int level = 0; level < LEVEL_COUNT && !error; level++) {
        sqlite3_stmt *clear = month_sql(file, SQL_CLEAR_ROLLUPS);
        sqlite3_bind_int64(clear, 1, history_level_us[level] / US_PER_S);
        sqlite3_bind_int64(clear, 2, id);
        sqlite3_bind_int64(clear, 3, from_us);
        sqlite3_bind_int64(clear, 4, INT64_MAX);
        error = month_run(file, clear, "cannot roll up again");
    }
    reset_rollups(&rollups, file->tags[tag].step);
    if (!error)
        error = roll_from(file, id, from_us, &rollups, true);
    file->rollups[tag] = rollups;
    return error;
}

int month_file_import(struct month_file *file, int tag, const struct history_point *points, size_t count)
{
    int64_t id;
    if (!count)
        return 0;
    int error = month_file_tidy(file);
    if (error || (error = begin(file)))
        return error;
    error = tag_id(file, tag, &id);
    for (size_t i = 0; i < count && !error; i++)
        error = record(file, SQL_ADD_SAMPLE, id, &points[i]);
    if (!error)
        error = roll_again(file, tag, id, points[0].t_us);
    return end(file, error);
}

static int forget(struct month_file *file, int which, int64_t from_us, int64_t to_us, uint32_t gap_quality)
{
    sqlite3_stmt *s = month_sql(file, which);
    sqlite3_bind_int64(s, 1, from_us);
    sqlite3_bind_int64(s, 2, to_us);
    if (which != SQL_FORGET_GAP_NOTES)
        sqlite3_bind_int64(s, 3, gap_quality);
    return month_run(file, s, "cannot forget a gap");
}

int month_file_forget_gaps(struct month_file *file, int64_t from_us, int64_t to_us, uint32_t gap_quality)
{
    bool has_outbox = false;
    int error = month_file_tidy(file);
    if (error || (error = month_has_outbox(file, &has_outbox)) || (error = begin(file)))
        return error;
    error = forget(file, SQL_FORGET_GAPS, from_us, to_us, gap_quality);
    if (!error)
        error = forget(file, SQL_FORGET_GAP_NOTES, from_us, to_us, gap_quality);
    if (!error && has_outbox) /* deletes the gap's point from the outbox too, so that it is not sent to PostgreSQL */
        error = forget(file, SQL_FORGET_OUTBOX_GAPS, from_us, to_us, gap_quality);
    return end(file, error);
}

/* Records the held points (newest samples), each followed by a point that marks a gap. Without sends_gaps the gap points are not sent to
   PostgreSQL, where another daemon continues the lines. */
static int end_lines(struct month_file *file, uint32_t gap_quality, bool sends_gaps, int64_t *ended_us)
{
    sqlite3_stmt *held = month_sql(file, SQL_ALL_HELD);
    int code, error = 0;
    while (!error && (code = database_step(&file->db, held)) == SQLITE_ROW) {
        int64_t id = sqlite3_column_int64(held, 0);
        struct history_point point = month_point(held, 1);
        struct history_point gap = { .t_us = point.t_us + 1, .value = NAN, .quality = gap_quality };
        bool ends = point.quality == gap_quality;
        error = !ends || sends_gaps ? record(file, SQL_ADD_RECENT, id, &point) : put(file, SQL_ADD_RECENT, id, &point);
        if (!error && !ends) {
            error = sends_gaps ? record(file, SQL_ADD_RECENT, id, &gap) : put(file, SQL_ADD_RECENT, id, &gap);
            file->waiting++;
        }
        file->waiting++;
        if (point.t_us > *ended_us)
            *ended_us = point.t_us;
    }
    sqlite3_reset(held);
    return error ? error : database_fail(&file->db, code, "cannot read held points");
}

int month_file_clear_held(struct month_file *file)
{
    return month_run(file, month_sql(file, SQL_CLEAR_HELD), "cannot clear held points");
}

int month_file_recover(struct month_file *file, uint32_t gap_quality, bool sends_gaps, int64_t *ended_us)
{
    size_t waiting = file->waiting;
    int error = begin(file);
    if (error)
        return error;
    *ended_us = INT64_MIN;
    error = end_lines(file, gap_quality, sends_gaps, ended_us);
    if (!error)
        error = month_file_clear_held(file);
    error = end(file, error);
    if (error)
        file->waiting = waiting;
    return error;
}
