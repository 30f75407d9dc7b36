/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads points, rollups, events and gaps from a month's history file. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "history/month.h"
#include "history/month_blocks.h"
#include "history/month_seconds.h"

int month_file_begin_read(struct month_file *file)
{
    return month_run(file, month_sql(file, SQL_BEGIN_READ), "cannot be read");
}

void month_file_end_read(struct month_file *file)
{
    database_run(&file->db, month_sql(file, SQL_COMMIT));
}

void month_file_show_by(struct month_file *file, const struct plant *plant)
{
    file->shown_by = plant;
}

/* Returns the unit in which the plant now shows the tag; NULL: values keep the unit stored in the file. */
static const char *unit_shown(const struct month_file *file, const char *name)
{
    int tag = file->shown_by ? plant_find_tag(file->shown_by, name) : -1;
    return tag >= 0 ? file->shown_by->tags[tag].unit : NULL;
}

bool history_unit_fits(const char *from, const char *to, struct unit_change *change)
{
    *change = (struct unit_change){ 0 };
    return !*from || !*to || units_compare(from, to, change) <= UNITS_CONVERT;
}

int64_t month_find_tag(struct month_file *file, const char *name, const char *wanted, bool *step, struct unit_change *change)
{
    *change = (struct unit_change){ 0 };
    sqlite3_stmt *find = month_sql(file, SQL_FIND_TAG);
    int64_t id = 0;
    database_bind_text(find, 1, name);
    while (!id && database_step(&file->db, find) == SQLITE_ROW) {
        if (wanted && !history_unit_fits(database_text(find, 2), wanted, change))
            continue;
        id = sqlite3_column_int64(find, 0);
        *step = sqlite3_column_int(find, 1) != 0;
    }
    sqlite3_reset(find);
    return id;
}

/* Finds a tag's last point at or before t_us (SQL_BEFORE) or first point after t_us (SQL_AFTER) in the table `sample`; out->t_us is
   INT64_MIN if there is none. */
static int one_point(struct month_file *file, enum month_statement which, int64_t id, int64_t t_us, struct history_point *out)
{
    sqlite3_stmt *statement = month_sql(file, which);
    out->t_us = INT64_MIN;
    sqlite3_bind_int64(statement, 1, id);
    sqlite3_bind_int64(statement, 2, t_us);
    int code = database_step(&file->db, statement);
    if (code == SQLITE_ROW)
        *out = month_point(statement, 0);
    sqlite3_reset(statement);
    return database_fail(&file->db, code, "cannot be read");
}

static int add_points(struct month_file *file, sqlite3_stmt *statement, struct history_points *out)
{
    int code;
    while ((code = database_step(&file->db, statement)) == SQLITE_ROW) {
        struct history_point point = month_point(statement, 0);
        history_points_add(out, &point);
    }
    sqlite3_reset(statement);
    return database_fail(&file->db, code, "cannot be read");
}

static int by_time(const void *a, const void *b)
{
    const struct history_point *x = a, *y = b;
    return (x->t_us > y->t_us) - (x->t_us < y->t_us);
}

/* Appends a tag's newest points, which are not in blocks yet, and its held sample (newest, not recorded yet), sorted by time. */
static int add_recent(struct month_file *file, int64_t id, struct history_points *out)
{
    const struct month_seconds *seconds = file->seconds;
    sqlite3_stmt *of = month_sql(file, SQL_RECENT_OF), *held = month_sql(file, SQL_HELD_OF);
    sqlite3_bind_int64(of, 1, id);
    sqlite3_bind_int64(held, 1, id);
    int error = add_points(file, of, out);
    if (!error)
        error = month_seconds_read(file);
    for (size_t i = 0; i < seconds->count && !error; i++)
        if (seconds->rows[i].id == id)
            history_points_add(out, &seconds->rows[i].point);
    if (!error && (size_t)id < seconds->held_count && seconds->held[id].id)
        history_points_add(out, &seconds->held[id].point);
    else if (!error)
        error = add_points(file, held, out);
    if (out->count)
        qsort(out->at, out->count, sizeof(*out->at), by_time);
    return error;
}

/* Appends a tag's points from the table `sample`, written by versions 1 and 2 of the file format. */
static int add_samples(struct month_file *file, int64_t id, int64_t from_us, int64_t to_us, struct history_points *out)
{
    struct history_point edge;
    int error = one_point(file, SQL_BEFORE, id, from_us - 1, &edge);
    if (error)
        return error;
    if (edge.t_us != INT64_MIN)
        history_points_add(out, &edge);
    sqlite3_stmt *range = month_sql(file, SQL_RANGE);
    sqlite3_bind_int64(range, 1, id);
    sqlite3_bind_int64(range, 2, from_us);
    sqlite3_bind_int64(range, 3, to_us);
    sqlite3_bind_int64(range, 4, out->max ? (int64_t)out->max + 1 : -1);
    error = add_points(file, range, out);
    if (!error)
        error = one_point(file, SQL_AFTER, id, to_us, &edge);
    if (!error && edge.t_us != INT64_MIN)
        history_points_add(out, &edge);
    return error;
}

/* Removes points that a query need not return: keeps only the last before from_us, only the first after to_us, and the newer
   row of two with equal times. */
static void trim(struct history_points *points, size_t begin, int64_t from_us, int64_t to_us)
{
    size_t kept = begin;
    for (size_t i = begin; i < points->count; i++) {
        const struct history_point point = points->at[i];
        if (kept > begin && (points->at[kept - 1].t_us == point.t_us || (point.t_us <= from_us && points->at[kept - 1].t_us < from_us)))
            kept--;
        else if (kept > begin && points->at[kept - 1].t_us > to_us)
            break;
        points->at[kept++] = point;
    }
    points->count = kept;
}

int month_stored_points(struct month_file *file, int64_t id, int64_t from_us, int64_t to_us, struct history_points *out)
{
    struct history_points samples = { .max = out->max }, blocks = { .max = out->max };
    int error = add_samples(file, id, from_us, to_us, &samples);
    if (!error)
        error = month_blocks_read(file, id, from_us, to_us, &blocks);
    size_t begin = out->count;
    month_points_merge(&samples, &blocks, out);
    trim(out, begin, from_us, to_us);
    mem_free(samples.at);
    mem_free(blocks.at);
    return error;
}

/* Appends the points of a tag's series, in the unit stored in the file. */
static int add_series(struct month_file *file, int64_t id, int64_t from_us, int64_t to_us, struct history_points *out)
{
    size_t begin = out->count;
    struct history_points stored = { .max = out->max }, recent = { 0 };
    int error = month_stored_points(file, id, from_us, to_us, &stored);
    if (!error)
        error = add_recent(file, id, &recent);
    month_points_merge(&stored, &recent, out);
    trim(out, begin, from_us, to_us);
    mem_free(stored.at);
    mem_free(recent.at);
    return error;
}

int month_file_points(struct month_file *file, const char *tag, int64_t from_us, int64_t to_us, struct history_points *out)
{
    size_t begin = out->count;
    struct unit_change change;
    int64_t id = month_find_tag(file, tag, unit_shown(file, tag), &out->step, &change);
    int error = id ? add_series(file, id, from_us, to_us, out) : 0;
    for (size_t i = begin; i < out->count; i++)
        out->at[i].value = unit_change_value(&change, out->at[i].value);
    return error;
}

int month_file_left_out(struct month_file *file, const char *tag, int64_t from_us, int64_t to_us, struct history_left_out *out)
{
    const char *wanted = unit_shown(file, tag);
    sqlite3_stmt *find = month_sql(file, SQL_FIND_TAG);
    struct history_points points = { 0 };
    struct unit_change change;
    int code = SQLITE_DONE, error = 0;
    database_bind_text(find, 1, tag);
    while (wanted && !error && (code = database_step(&file->db, find)) == SQLITE_ROW) {
        if (history_unit_fits(database_text(find, 2), wanted, &change))
            continue;
        points.count = 0;
        error = add_series(file, sqlite3_column_int64(find, 0), from_us, to_us, &points);
        for (size_t i = 0; i < points.count; i++)
            out->count += history_point_usable(&points.at[i]) && points.at[i].t_us >= from_us && points.at[i].t_us <= to_us;
        if (!*out->unit)
            snprintf(out->unit, sizeof(out->unit), "%s", database_text(find, 2));
    }
    sqlite3_reset(find);
    mem_free(points.at);
    return error ? error : database_fail(&file->db, code, "cannot be read");
}

int month_file_buckets(struct month_file *file, const char *tag, enum history_level level, int64_t from_us, int64_t to_us,
                       struct month_buckets *out)
{
    struct history_buckets *buckets = &out->buckets;
    struct unit_change change;
    int64_t id = month_find_tag(file, tag, unit_shown(file, tag), &out->step, &change), length_us = history_level_us[level];
    out->until_us = from_us;
    if (!id)
        return 0;
    sqlite3_stmt *rollups = month_sql(file, SQL_ROLLUPS);
    sqlite3_bind_int64(rollups, 1, length_us / US_PER_S);
    sqlite3_bind_int64(rollups, 2, id);
    sqlite3_bind_int64(rollups, 3, from_us);
    sqlite3_bind_int64(rollups, 4, to_us);
    int code;
    while ((code = database_step(&file->db, rollups)) == SQLITE_ROW) {
        struct history_bucket bucket = {
            .t_us = sqlite3_column_int64(rollups, 0),
            .low = unit_change_value(&change, database_value(rollups, 1)),
            .high = unit_change_value(&change, database_value(rollups, 2)),
            .mean = unit_change_value(&change, database_value(rollups, 3)),
            .first = unit_change_value(&change, database_value(rollups, 4)),
            .last = unit_change_value(&change, database_value(rollups, 5)),
            .good_us = sqlite3_column_int64(rollups, 6),
            .bad_us = sqlite3_column_int64(rollups, 7),
            .quality = (uint32_t)sqlite3_column_int64(rollups, 8),
        };
        mem_grow(&buckets->at, &buckets->capacity, buckets->count + 1, sizeof(*buckets->at));
        buckets->at[buckets->count++] = bucket;
        out->until_us = bucket.t_us + length_us;
    }
    sqlite3_reset(rollups);
    return database_fail(&file->db, code, "cannot be read");
}

/* --- one instant -------------------------------------------------------------------------------------------------------------- */

static void take(struct history_pair *pair, const struct history_point *there, int64_t t_us)
{
    struct history_point point = *there;
    if (point.t_us == INT64_MIN)
        return;
    point.value = unit_change_value(&pair->change, point.value);
    if (point.t_us <= t_us && point.t_us >= pair->before.t_us)
        pair->before = point;
    if (point.t_us > t_us && (pair->after.t_us == INT64_MIN || point.t_us < pair->after.t_us))
        pair->after = point;
}

/* Returns true if this file must be searched for a tag, because the files searched before lack the tag's point before the
   requested time or the point after it, and this file's month may have that point. month: month of the requested time. */
static bool is_searched(const struct month_file *file, const struct history_pair *pair, int month)
{
    return (file->month <= month && pair->before.t_us == INT64_MIN) || (file->month >= month && pair->after.t_us == INT64_MIN);
}

/* Returns an array that maps a tag's id in the file to its index in `tags`; -1: not in `tags`, or no point of the tag is sought
   in this file. Returns NULL if the file has none of the tags. Free with mem_free(). */
static int *index_by_id(struct month_file *file, int64_t t_us, const struct history_tag *tags, size_t count, struct history_pair *pairs,
                        int64_t *most)
{
    int month = month_of(t_us);
    int64_t *ids = mem_array(count ? count : 1, sizeof(*ids));
    *most = 0;
    for (size_t i = 0; i < count; i++) {
        if (is_searched(file, &pairs[i], month))
            ids[i] = month_find_tag(file, tags[i].name, tags[i].unit, &pairs[i].step, &pairs[i].change);
        if (ids[i] > *most)
            *most = ids[i];
    }
    int *index = *most ? mem_array((size_t)*most + 1, sizeof(*index)) : NULL;
    if (index)
        memset(index, 0xff, ((size_t)*most + 1) * sizeof(*index));
    for (size_t i = 0; i < count; i++)
        if (ids[i])
            index[ids[i]] = (int)i;
    mem_free(ids);
    return index;
}

static void take_of(const int *index, int64_t most, int64_t id, const struct history_point *point, int64_t t_us, struct history_pair *pairs)
{
    if (id > 0 && id <= most && index[id] >= 0)
        take(&pairs[index[id]], point, t_us);
}

/* Searches the newest points, which are not in blocks yet, and the held samples (not recorded yet) for the points around t_us. */
static int take_recent(struct month_file *file, int64_t t_us, const int *index, int64_t most, struct history_pair *pairs)
{
    const struct month_seconds *seconds = file->seconds;
    int code, error = month_seconds_read(file);
    for (size_t i = 0; i < seconds->count && !error; i++)
        take_of(index, most, seconds->rows[i].id, &seconds->rows[i].point, t_us, pairs);
    for (size_t id = 1; id < seconds->held_count && !error; id++)
        take_of(index, most, seconds->held[id].id, &seconds->held[id].point, t_us, pairs);
    for (int table = 0; table < 2 && !error; table++) {
        sqlite3_stmt *rows = month_sql(file, table ? SQL_ALL_HELD : SQL_RECENT_ALL);
        while ((code = database_step(&file->db, rows)) == SQLITE_ROW) {
            int64_t id = sqlite3_column_int64(rows, 0);
            struct history_point point = month_point(rows, 1);
            bool replaced = table && (size_t)id < seconds->held_count && seconds->held[id].id;
            if (!replaced)
                take_of(index, most, id, &point, t_us, pairs);
        }
        sqlite3_reset(rows);
        error = database_fail(&file->db, code, "cannot be read");
    }
    return error;
}

int month_file_at(struct month_file *file, int64_t t_us, const struct history_tag *tags, size_t count, struct history_pair *pairs)
{
    int64_t most;
    struct history_points points = { 0 };
    int error = 0, *index = index_by_id(file, t_us, tags, count, pairs, &most);
    for (int64_t id = 1; index && id <= most && !error; id++) {
        struct history_pair *pair = index[id] >= 0 ? &pairs[index[id]] : NULL;
        if (!pair)
            continue;
        points.count = 0;
        error = month_stored_points(file, id, t_us, t_us, &points);
        for (size_t i = 0; i < points.count; i++)
            take(pair, &points.at[i], t_us);
    }
    if (index && !error)
        error = take_recent(file, t_us, index, most, pairs);
    mem_free(points.at);
    mem_free(index);
    return error;
}

static int widen_by(struct month_file *file, enum month_statement which, int64_t *first_us, int64_t *last_us)
{
    sqlite3_stmt *span = month_sql(file, which);
    int code = database_step(&file->db, span);
    if (code == SQLITE_ROW && sqlite3_column_type(span, 0) != SQLITE_NULL) {
        int64_t first = sqlite3_column_int64(span, 0), last = sqlite3_column_int64(span, 1);
        *first_us = first < *first_us ? first : *first_us;
        *last_us = last > *last_us ? last : *last_us;
    }
    sqlite3_reset(span);
    return database_fail(&file->db, code, "cannot be read");
}

static void widen(const struct month_row *rows, size_t count, int64_t *first_us, int64_t *last_us)
{
    for (size_t i = 0; i < count; i++)
        if (rows[i].id) {
            *first_us = rows[i].point.t_us < *first_us ? rows[i].point.t_us : *first_us;
            *last_us = rows[i].point.t_us > *last_us ? rows[i].point.t_us : *last_us;
        }
}

int month_file_span(struct month_file *file, int64_t *first_us, int64_t *last_us)
{
    int64_t first = INT64_MAX, last = INT64_MIN;
    int error = widen_by(file, SQL_SPAN, &first, &last);
    if (!error && month_has_blocks(file))
        error = widen_by(file, SQL_BLOCK_SPAN, &first, &last);
    if (!error)
        error = month_seconds_read(file);
    widen(file->seconds->rows, file->seconds->count, &first, &last);
    widen(file->seconds->held, file->seconds->held_count, &first, &last);
    if (first <= last) {
        *first_us = first;
        *last_us = last;
    }
    return error;
}

/* Parses the text of an event by which the historian noted a gap in recording. Returns false for other events. */
static bool read_gap(const char *kind, const char *text, int64_t t_us, struct history_gap *out)
{
    double seconds;
    if (!strcmp(kind, "gap") && sscanf(text, "not recorded for %lf s", &seconds) == 1)
        *out = (struct history_gap){ t_us, t_us + (int64_t)(seconds * 1e6) };
    else if (!strcmp(kind, "clock") && sscanf(text, "the clock was set forward by %lf s", &seconds) == 1)
        *out = (struct history_gap){ t_us - (int64_t)(seconds * 1e6), t_us };
    else
        return false;
    return seconds > 0 && seconds < 1e10;
}

int month_file_gaps(struct month_file *file, struct history_gaps *out)
{
    sqlite3_stmt *events = month_sql(file, SQL_EVENTS);
    struct history_gap gap;
    int code;
    while ((code = database_step(&file->db, events)) == SQLITE_ROW) {
        if (!read_gap(database_text(events, 1), database_text(events, 2), sqlite3_column_int64(events, 0), &gap))
            continue;
        mem_grow(&out->at, &out->capacity, out->count + 1, sizeof(*out->at));
        out->at[out->count++] = gap;
    }
    sqlite3_reset(events);
    return database_fail(&file->db, code, "cannot be read");
}
