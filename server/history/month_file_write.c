/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes a month's history file. Points are first written in order of time; later they are sorted by tag, compressed and
   summarised as rollups. */
#include <stdlib.h>
#include <string.h>

#include "base/math/search.h"
#include "base/mem.h"
#include "history/month.h"
#include "history/month_blocks.h"
#include "history/month_outbox.h"
#include "history/month_seconds.h"
#include "value/quality.h"

/* --- transactions ------------------------------------------------------------------------------------------------------------- */

static int begin(struct month_file *file)
{
    file->slot_before = file->slot;
    file->stamp_before = file->stamp;
    return month_run(file, month_sql(file, SQL_BEGIN), "cannot begin a transaction");
}

/* Commits the transaction if `error` is 0, otherwise rolls it back. After a rollback, the tag ids and rollups in memory may
   differ from the file, so they are reset. */
static int end(struct month_file *file, int error)
{
    if (!error)
        error = month_run(file, month_sql(file, SQL_COMMIT), "cannot commit a transaction");
    if (!error)
        return 0;
    if (!sqlite3_get_autocommit(file->db.handle))
        database_run(&file->db, month_sql(file, SQL_ROLLBACK));
    memset(file->rollups, 0, file->tag_count * sizeof(*file->rollups));
    memset(file->ids, 0, file->tag_count * sizeof(*file->ids));
    file->slot = file->slot_before;
    file->stamp = file->stamp_before;
    file->chunk->id = 0; /* drops the cached chunk, because after the rollback the next chunk may get the same id with other times */
    return error;
}

static bool convert_points(void *arg, struct history_points *points)
{
    for (size_t i = 0; i < points->count; i++)
        points->at[i].value = unit_change_value(arg, points->at[i].value);
    return true;
}

static int put(struct month_file *file, enum month_statement which, int64_t id, const struct history_point *point)
{
    sqlite3_stmt *statement = month_sql(file, which);
    sqlite3_bind_int64(statement, 1, id);
    sqlite3_bind_int64(statement, 2, point->t_us);
    database_bind_value(statement, 3, point->value);
    sqlite3_bind_int64(statement, 4, point->quality);
    return month_run(file, statement, "cannot write a point");
}

static int rename_series(struct month_file *file, int64_t id, const char *name)
{
    sqlite3_stmt *rename = month_sql(file, SQL_RENAME_TAG);
    sqlite3_bind_int64(rename, 1, id);
    database_bind_text(rename, 2, name);
    return month_run(file, rename, "cannot rename a tag");
}

static void report_set_aside(struct month_file *file, const struct history_tag *of, int64_t id, const struct history_points *points)
{
    sqlite3_stmt *find = month_sql(file, SQL_TAG_UNIT);
    size_t count = 0;
    for (size_t i = 0; i < points->count; i++)
        count += history_point_usable(&points->at[i]);
    sqlite3_bind_int64(find, 1, id);
    if (database_step(&file->db, find) == SQLITE_ROW)
        log_warn(file->db.log, "%s: tag %s: %zu points in '%s' are left out from now on, because '%s' cannot be converted to '%s'",
                 file->db.path, of->name, count, database_text(find, 0), database_text(find, 0), of->unit);
    sqlite3_reset(find);
}

/* Renames a series of the tag that is not in the tag's present unit: readers find it by its unit. */
static int rename_aside(struct month_file *file, const struct history_tag *of, int64_t id)
{
    char *name = mem_printf("%s\x1f%lld", of->name, (long long)id);
    int error = rename_series(file, id, name);
    mem_free(name);
    return error;
}

/* Ends the tag's series in this file and renames it, because its unit cannot be converted to the unit that the tag has now. The
   series keeps its points and its unit. Readers skip it unless the tag later gets a unit to which that of the series can be
   converted. */
static int set_series_aside(struct month_file *file, const struct history_tag *of, int64_t id)
{
    static const struct month_chunk own = { 0 };
    struct history_points points = { 0 };
    int error = month_stored_points(file, id, 0, INT64_MAX, &points);
    const struct history_point *last = points.count ? &points.at[points.count - 1] : NULL;
    if (!error && last && history_point_usable(last)) {
        const struct history_point end = { last->t_us + 1, NAN, QUALITY_BAD_NO_COMMUNICATION };
        error = month_blocks_write(file, id, &own, &end, 1);
        if (!error && file->has_outbox)
            error = put(file, SQL_ADD_OUTBOX, id, &end);
    }
    if (!error)
        error = rename_aside(file, of, id);
    if (!error)
        report_set_aside(file, of, id, &points);
    mem_free(points.at);
    return error;
}

/* Makes the tag's series in this file match the unit in which the plant now shows the tag: sets aside a series that cannot be
   converted, and converts the values of one that can. At this point the table `second` (newest points) has no point of the tag,
   because month_file_write() first moves the points of earlier handles to blocks. */
static int fit_unit(struct month_file *file, int tag)
{
    const struct history_tag *of = &file->tags[tag];
    struct unit_change change;
    bool step;
    int64_t newest = month_find_tag(file, of->name, NULL, &step, &change);
    int64_t id = month_find_tag(file, of->name, of->unit, &step, &change);
    if (id != newest) {
        int moved = newest ? set_series_aside(file, of, newest) : 0;
        /* continues the tag's earlier series, which was set aside when the unit changed, because it can be converted to the
           present unit */
        if (!moved && id)
            moved = rename_series(file, id, of->name);
        file->rollups[tag].loaded = false;
        if (moved)
            return moved;
    }
    if (!id || !change.converts)
        return 0;
    static const char *const columns[][2] = { { "sample", "v" },     { "recent", "v" },    { "held", "v" },
                                              { "rollup", "low" },   { "rollup", "high" }, { "rollup", "mean" },
                                              { "rollup", "first" }, { "rollup", "last" }, { "outbox", "v" } };
    /* true: the file has an outbox (points to send to PostgreSQL), because PostgreSQL was configured when the file was written;
       the values there must be converted, too */
    bool has_outbox;
    int error = month_has_outbox(file, &has_outbox);
    size_t count = sizeof(columns) / sizeof(columns[0]) - !has_outbox;
    for (size_t i = 0; i < count && !error; i++) {
        char *sql = mem_printf("UPDATE %s SET %s = %s * %.17g + %.17g WHERE tag = %lld", columns[i][0], columns[i][1], columns[i][1],
                               change.factor, change.offset, (long long)id);
        error = database_exec(&file->db, sql, "cannot convert recorded points to the tag's new unit");
        mem_free(sql);
    }
    file->rollups[tag].loaded = false;
    return error ? error : month_blocks_edit(file, id, INT64_MIN, INT64_MAX, convert_points, &change);
}

/* Adds a series with this name and the tag's properties, or sets the properties of the series that has this name. */
static int put_series(struct month_file *file, const struct history_tag *of, const char *name, int64_t *id)
{
    sqlite3_stmt *add = month_sql(file, SQL_ADD_TAG);
    database_bind_text(add, 1, name);
    database_bind_text(add, 2, of->unit);
    sqlite3_bind_int(add, 3, of->step);
    sqlite3_bind_double(add, 4, of->within);
    int code = database_step(&file->db, add);
    if (code == SQLITE_ROW)
        *id = sqlite3_column_int64(add, 0);
    int error = database_fail(&file->db, code, "cannot add a tag");
    sqlite3_reset(add);
    return error;
}

static int tag_id(struct month_file *file, int tag, int64_t *id)
{
    const struct history_tag *of = &file->tags[tag];
    *id = file->ids[tag];
    if (*id)
        return 0;
    int error = fit_unit(file, tag);
    if (!error)
        error = put_series(file, of, of->name, id);
    if (!error)
        file->ids[tag] = *id;
    return error;
}

/* Replaces each row's tag index with the tag's id in the file. Returns the new rows in *with_ids, which the caller frees. */
static int find_ids(struct month_file *file, const struct history_row *rows, size_t count, struct month_row **with_ids)
{
    int error = 0;
    *with_ids = mem_array(count + 1, sizeof(**with_ids));
    for (size_t i = 0; i < count && !error; i++) {
        (*with_ids)[i].point = rows[i].point;
        error = tag_id(file, rows[i].tag, &(*with_ids)[i].id);
    }
    return error;
}

/* Copies the recorded points to the outbox and the newest samples to the table `held`, from which the PostgreSQL sender thread
   takes them. */
static int put_outbox(struct month_file *file, const struct month_row *rows, size_t count, const struct month_row *held, size_t held_count)
{
    int error = 0;
    for (size_t i = 0; i < count && !error; i++)
        error = put(file, SQL_ADD_OUTBOX, rows[i].id, &rows[i].point);
    for (size_t i = 0; i < held_count && !error; i++)
        error = put(file, SQL_HOLD, held[i].id, &held[i].point);
    return error;
}

int month_file_write(struct month_file *file, const struct history_row *rows, size_t count, const struct history_row *held,
                     size_t held_count)
{
    struct month_row *recorded = NULL, *newest = NULL;
    /* moves points left in the table `second` by an earlier handle to compressed blocks */
    int error = file->writes ? 0 : month_file_tidy(file);
    if (error || (error = begin(file)))
        return error;
    error = find_ids(file, rows, count, &recorded);
    if (!error)
        error = find_ids(file, held, held_count, &newest);
    if (!error)
        error = month_seconds_write(file, recorded, count, newest, held_count);
    if (!error && file->has_outbox)
        error = put_outbox(file, recorded, count, newest, held_count);
    error = end(file, error);
    file->writes |= !error;
    file->waiting += error ? 0 : count + 1;
    mem_free(recorded);
    mem_free(newest);
    return error;
}

int month_file_use_outbox(struct month_file *file)
{
    int error = database_exec(&file->db, MONTH_OUTBOX_SCHEMA, "cannot create the table `outbox` of points to send to PostgreSQL");
    file->has_outbox = !error;
    return error;
}

int month_file_note(struct month_file *file, int64_t t_us, const char *kind, const char *text)
{
    sqlite3_stmt *note = month_sql(file, SQL_NOTE);
    sqlite3_bind_int64(note, 1, t_us);
    database_bind_text(note, 2, kind);
    database_bind_text(note, 3, text);
    return month_run(file, note, "cannot record an event in the history file");
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
    return month_run(file, add, "cannot write a rollup");
}

static void reset_rollups(struct month_rollups *rollups, bool step)
{
    *rollups = (struct month_rollups){ .loaded = true };
    for (int level = 0; level < LEVEL_COUNT; level++)
        rollups->level[level] = (struct rollup){ .length_us = history_level_us[level], .step = step };
}

/* Computes the rollups from the points since the start of the hour of from_us, and from the last point before. Writes complete
   buckets to the file and leaves incomplete ones in *rollups. */
static int roll_from(struct month_file *file, int64_t id, int64_t from_us, struct month_rollups *rollups)
{
    int64_t hour_us = from_us - from_us % history_level_us[LEVEL_1_H];
    struct history_points points = { 0 };
    int error = month_stored_points(file, id, hour_us - 1, INT64_MAX, &points);
    for (size_t i = 0; i < points.count; i++) {
        struct history_bucket closed;
        for (int level = 0; level < LEVEL_COUNT && !error; level++)
            if (rollup_put(&rollups->level[level], &points.at[i], &closed) && closed.t_us >= hour_us)
                error = put_bucket(file, id, history_level_us[level], &closed);
    }
    mem_free(points.at);
    return error;
}

/* Finds a tag's newest point at or before t_us; before->t_us INT64_MIN: there is none. */
static int find_before(struct month_file *file, int64_t id, int64_t t_us, struct history_point *before)
{
    struct history_points points = { 0 };
    int error = month_stored_points(file, id, t_us, t_us, &points);
    before->t_us = INT64_MIN;
    for (size_t i = 0; i < points.count && points.at[i].t_us <= t_us; i++)
        *before = points.at[i];
    mem_free(points.at);
    return error;
}

/* Finds the end of the tag's newest rollup bucket of an hour; the beginning of the month if there is none. */
static int find_rolled(struct month_file *file, int64_t id, int64_t *end_us)
{
    sqlite3_stmt *newest = month_sql(file, SQL_NEWEST_ROLLUP);
    sqlite3_bind_int64(newest, 1, history_level_us[LEVEL_1_H] / US_PER_S);
    sqlite3_bind_int64(newest, 2, id);
    int code = database_step(&file->db, newest);
    bool has = code == SQLITE_ROW && sqlite3_column_type(newest, 0) != SQLITE_NULL;
    *end_us = has ? sqlite3_column_int64(newest, 0) + history_level_us[LEVEL_1_H] : month_begin_us(file->month);
    sqlite3_reset(newest);
    return database_fail(&file->db, code, "cannot be read");
}

/* Restores a tag's incomplete rollup buckets in memory from the points that the previous writer left in the file. Also writes complete
   buckets that are missing, because a handle of a plant without this tag moved its points (move_tag()). */
static int load_rollups(struct month_file *file, int tag, int64_t id)
{
    struct month_rollups *rollups = &file->rollups[tag];
    struct history_point last;
    int64_t from_us;
    reset_rollups(rollups, file->tags[tag].step);
    int error = find_before(file, id, INT64_MAX, &last);
    if (error || last.t_us == INT64_MIN || (error = find_rolled(file, id, &from_us)))
        return error;
    return roll_from(file, id, from_us < last.t_us ? from_us : last.t_us, rollups);
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

/* --- moving the newest points to blocks --------------------------------------------------------------------------------------- */

static int by_tag_and_time(const void *a, const void *b)
{
    const struct month_row *x = a, *y = b;
    if (x->id != y->id)
        return x->id < y->id ? -1 : 1;
    if (x->point.t_us != y->point.t_us)
        return x->point.t_us < y->point.t_us ? -1 : 1;
    return x->order < y->order ? -1 : 1;
}

/* Stores each distinct time of the rows once, in a chunk that the blocks of these rows share. The caller frees chunk->times. */
static int share_times(struct month_file *file, const struct month_row *rows, size_t count, struct month_chunk *chunk)
{
    chunk->times = mem_array(count + 1, sizeof(*chunk->times));
    for (size_t i = 0; i < count; i++)
        chunk->times[i] = rows[i].point.t_us;
    qsort(chunk->times, count, sizeof(*chunk->times), compare_int64);
    for (size_t i = 0; i < count; i++)
        if (chunk->count == 0 || chunk->times[i] != chunk->times[chunk->count - 1])
            chunk->times[chunk->count++] = chunk->times[i];
    return month_chunk_store(file, chunk);
}

/* Writes one tag's newest points to blocks and updates its rollups. tag -1: the plant of this handle does not have the tag, so no
   rollups are computed. `points` is a scratch buffer. */
static int move_tag(struct month_file *file, int tag, const struct month_chunk *chunk, const struct month_row *rows, size_t count,
                    struct history_points *points)
{
    int error = 0;
    if (tag >= 0 && !file->rollups[tag].loaded)
        /* the incomplete rollup buckets must be loaded before the new points are written to blocks: load_rollups() reads the
           blocks, so these points would otherwise count twice */
        error = load_rollups(file, tag, rows->id);
    points->count = 0;
    for (size_t i = 0; i < count && !error; i++) {
        if (points->count && points->at[points->count - 1].t_us == rows[i].point.t_us)
            points->count--;
        history_points_add(points, &rows[i].point);
        if (tag >= 0)
            error = roll_point(file, tag, rows->id, &rows[i].point);
    }
    return error ? error : month_blocks_write(file, rows->id, chunk, points->at, points->count);
}

static int move_rows(struct month_file *file, struct month_row *rows, size_t count, const int *tags, int64_t id_max)
{
    struct month_chunk chunk = { 0 };
    struct history_points points = { 0 };
    if (count)
        qsort(rows, count, sizeof(*rows), by_tag_and_time);
    int error = share_times(file, rows, count, &chunk);
    for (size_t i = 0, end; i < count && !error; i = end) {
        for (end = i; end < count && rows[end].id == rows[i].id;)
            end++;
        error = move_tag(file, rows[i].id <= id_max ? tags[rows[i].id] : -1, &chunk, rows + i, end - i, &points);
    }
    mem_free(chunk.times);
    mem_free(points.at);
    return error;
}

/* Returns an array that maps tag ids of the file to tag indices of the plant; -1: none. Does not use tag_id(), which would
   convert units, because the newest points still have the file's unit. Free with mem_free(). */
static int *tags_by_id(struct month_file *file, int64_t *id_max)
{
    int64_t *ids = mem_array(file->tag_count + 1, sizeof(*ids));
    *id_max = 0;
    for (size_t i = 0; i < file->tag_count; i++) {
        bool step;
        struct unit_change change;
        ids[i] = file->ids[i] ? file->ids[i] : month_find_tag(file, file->tags[i].name, NULL, &step, &change);
        *id_max = ids[i] > *id_max ? ids[i] : *id_max;
    }
    int *tags = mem_array((size_t)*id_max + 1, sizeof(*tags));
    memset(tags, 0xff, ((size_t)*id_max + 1) * sizeof(*tags));
    for (size_t i = 0; i < file->tag_count; i++)
        if (ids[i])
            tags[ids[i]] = (int)i;
    mem_free(ids);
    return tags;
}

static int move_seconds(struct month_file *file)
{
    struct month_seconds *seconds = file->seconds;
    int error = month_seconds_read(file);
    if (error)
        return error;
    if (seconds->mark != file->mark)
        /* the incomplete rollup buckets in memory lack the points that another handle moved or imported: reloads the buckets */
        memset(file->rollups, 0, file->tag_count * sizeof(*file->rollups));
    int64_t id_max;
    int *tags = tags_by_id(file, &id_max);
    error = move_rows(file, seconds->rows, seconds->count, tags, id_max);
    for (size_t id = 0; id < seconds->held_count && !error; id++)
        if (seconds->held[id].id)
            error = put(file, SQL_HOLD, (int64_t)id, &seconds->held[id].point);
    mem_free(tags);
    return error ? error : month_seconds_clear(file);
}

int month_file_tidy(struct month_file *file)
{
    if (!file->waiting)
        return 0;
    int error = begin(file);
    if (error)
        return error;
    error = end(file, move_seconds(file));
    month_seconds_finish(file);
    if (!error)
        file->waiting = 0;
    return error;
}

/* --- imports and recovery ----------------------------------------------------------------------------------------------------- */

static int roll_again(struct month_file *file, int tag, int64_t id, int64_t from_us)
{
    struct month_rollups rollups;
    struct history_point before;
    int error = find_before(file, id, from_us - 1, &before);
    /* the straight line from the last point before from_us now ends at an imported point, so buckets in between change, too */
    if (before.t_us != INT64_MIN)
        from_us = before.t_us;
    from_us -= from_us % history_level_us[LEVEL_1_H];
    for (int level = 0; level < LEVEL_COUNT && !error; level++) {
        sqlite3_stmt *clear = month_sql(file, SQL_CLEAR_ROLLUPS);
        sqlite3_bind_int64(clear, 1, history_level_us[level] / US_PER_S);
        sqlite3_bind_int64(clear, 2, id);
        sqlite3_bind_int64(clear, 3, from_us);
        sqlite3_bind_int64(clear, 4, INT64_MAX);
        error = month_run(file, clear, "cannot delete outdated minima, maxima and means from the history file");
    }
    reset_rollups(&rollups, file->tags[tag].step);
    if (!error)
        error = roll_from(file, id, from_us, &rollups);
    file->rollups[tag] = rollups;
    struct unit_change none;
    bool step;
    /* an import may add to a series that is not the one recorded now */
    file->rollups[tag].loaded = month_find_tag(file, file->tags[tag].name, NULL, &step, &none) == id;
    return error;
}

/* Begins a transaction that changes points in blocks. First moves the newest points of other handles to blocks, which also makes
   those handles reload their rollup buckets. */
static int begin_change(struct month_file *file)
{
    int64_t mark = 0;
    int error = begin(file);
    if (error)
        return error;
    error = month_seconds_mark(file, &mark);
    if (!error && mark != file->mark)
        error = move_seconds(file);
    month_seconds_finish(file);
    return error ? end(file, error) : 0;
}

/* Finds the series to which an import adds points of a tag, and the conversion from the unit of this series to the plant's. The unit
   of the series stays as it is, because another handle may be recording in this unit. If the units of all series of the tag cannot be
   converted to the plant's, adds a series that readers find by its unit, and that fit_unit() later continues. */
static int import_series(struct month_file *file, int tag, int64_t *id, struct unit_change *change)
{
    const struct history_tag *of = &file->tags[tag];
    bool step;
    *id = month_find_tag(file, of->name, of->unit, &step, change);
    if (*id) {
        sqlite3_stmt *set = month_sql(file, SQL_SET_STEP);
        sqlite3_bind_int64(set, 1, *id);
        sqlite3_bind_int(set, 2, of->step);
        sqlite3_bind_double(set, 3, of->within);
        return month_run(file, set, "cannot change a tag");
    }
    struct unit_change none;
    bool has_other = month_find_tag(file, of->name, NULL, &step, &none) != 0;
    if (!has_other)
        return put_series(file, of, of->name, id);
    char *name = mem_printf("%s\x1f", of->name); /* no other series has this name */
    int error = put_series(file, of, name, id);
    mem_free(name);
    return error ? error : rename_aside(file, of, *id);
}

int month_file_import(struct month_file *file, int tag, const struct history_point *points, size_t count)
{
    int64_t id;
    if (!count)
        return 0;
    int error = begin_change(file);
    if (error)
        return error;
    static const struct month_chunk own = { 0 };
    struct unit_change change;
    struct history_point *stored = mem_array(count, sizeof(*stored));
    error = import_series(file, tag, &id, &change);
    for (size_t i = 0; i < count && !error; i++) {
        stored[i] = points[i];
        stored[i].value = unit_change_back(&change, points[i].value);
        if (file->has_outbox)
            error = put(file, SQL_ADD_OUTBOX, id, &stored[i]);
    }
    if (!error)
        error = month_blocks_write(file, id, &own, stored, count);
    if (!error)
        error = roll_again(file, tag, id, points[0].t_us);
    mem_free(stored);
    return end(file, error);
}

static int forget(struct month_file *file, int which, int64_t from_us, int64_t to_us, uint32_t gap_quality)
{
    sqlite3_stmt *s = month_sql(file, which);
    sqlite3_bind_int64(s, 1, from_us);
    sqlite3_bind_int64(s, 2, to_us);
    if (which != SQL_FORGET_GAP_NOTES)
        sqlite3_bind_int64(s, 3, gap_quality);
    return month_run(file, s, "cannot delete a gap");
}

struct gap_points {
    int64_t from_us, to_us;
    uint32_t quality;
};

static bool remove_gaps(void *arg, struct history_points *points)
{
    const struct gap_points *gap = arg;
    size_t kept = 0, before = points->count;
    for (size_t i = 0; i < before; i++) {
        const struct history_point *point = &points->at[i];
        if (point->t_us < gap->from_us || point->t_us > gap->to_us || point->quality != gap->quality)
            points->at[kept++] = *point;
    }
    points->count = kept;
    return kept < before;
}

static int forget_in_blocks(struct month_file *file, struct gap_points *gap)
{
    sqlite3_stmt *tags = month_sql(file, SQL_ALL_TAGS);
    int code = SQLITE_DONE, error = 0;
    while (!error && (code = database_step(&file->db, tags)) == SQLITE_ROW)
        error = month_blocks_edit(file, sqlite3_column_int64(tags, 0), gap->from_us, gap->to_us, remove_gaps, gap);
    sqlite3_reset(tags);
    return error ? error : database_fail(&file->db, code, "cannot read tags");
}

int month_file_forget_gaps(struct month_file *file, int64_t from_us, int64_t to_us, uint32_t gap_quality)
{
    struct gap_points gap = { from_us, to_us, gap_quality };
    bool has_outbox = false;
    int error = month_has_outbox(file, &has_outbox);
    if (error || (error = begin_change(file)))
        return error;
    error = forget(file, SQL_FORGET_GAPS, from_us, to_us, gap_quality);
    if (!error)
        error = forget_in_blocks(file, &gap);
    if (!error)
        error = forget(file, SQL_FORGET_GAP_NOTES, from_us, to_us, gap_quality);
    /* also deletes the points that mark the gap in recording from the outbox (points to be sent to PostgreSQL), so that they
       are not sent */
    if (!error && has_outbox)
        error = forget(file, SQL_FORGET_OUTBOX_GAPS, from_us, to_us, gap_quality);
    return end(file, error);
}

/* Records the held points (each tag's newest sample) and, after the newest held point, a gap point for each tag, because the
   values held until then. Without sends_gaps the gap points are not sent to PostgreSQL, where another daemon continues the
   lines. */
static int end_lines(struct month_file *file, uint32_t gap_quality, bool sends_gaps, int64_t *ended_us)
{
    sqlite3_stmt *held = month_sql(file, SQL_ALL_HELD);
    struct month_row *rows = NULL;
    size_t capacity = 0, count = 0;
    int code;
    while ((code = database_step(&file->db, held)) == SQLITE_ROW) {
        mem_grow(&rows, &capacity, 2 * count + 2, sizeof(*rows));
        rows[count++] = (struct month_row){ .id = sqlite3_column_int64(held, 0), .point = month_point(held, 1) };
        if (rows[count - 1].point.t_us > *ended_us)
            *ended_us = rows[count - 1].point.t_us;
    }
    sqlite3_reset(held);
    int error = database_fail(&file->db, code, "cannot read the newest sample of each tag from the history file");
    for (size_t i = 0, ends = count; i < ends; i++)
        if (rows[i].point.quality != gap_quality) {
            rows[count] = rows[i];
            rows[count++].point = (struct history_point){ .t_us = *ended_us + 1, .value = NAN, .quality = gap_quality };
        }
    for (size_t i = 0; i < count && !error && file->has_outbox; i++)
        if (sends_gaps || rows[i].point.quality != gap_quality)
            error = put(file, SQL_ADD_OUTBOX, rows[i].id, &rows[i].point);
    if (!error)
        error = month_seconds_write(file, rows, count, NULL, 0);
    file->waiting += error ? 0 : count;
    mem_free(rows);
    return error;
}

int month_file_clear_held(struct month_file *file)
{
    return month_run(file, month_sql(file, SQL_CLEAR_HELD), "cannot delete the list of newest samples from the file of a past month");
}

int month_file_recover(struct month_file *file, uint32_t gap_quality, bool sends_gaps, int64_t *ended_us)
{
    *ended_us = INT64_MIN;
    int error = month_file_tidy(file);
    if (error || (error = begin(file)))
        return error;
    error = end_lines(file, gap_quality, sends_gaps, ended_us);
    if (!error)
        error = month_file_clear_held(file);
    error = end(file, error);
    if (error)
        file->waiting = 0;
    return error;
}
