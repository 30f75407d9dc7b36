/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Restores history recorded on another machine from PostgreSQL to the files of this machine. */
#include "history/postgres/postgres_restore.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/files/atomic_file.h"
#include "base/files/database.h"
#include "base/mem.h"
#include "base/text/text.h"
#include "history/month.h"
#include "plant/tags/units.h"
#include "value/quality.h"

enum { POINTS_AT_ONCE = 100000, NUMBER_BYTES = 24, MARK_BYTES = 100 };

/* --- progress ----------------------------------------------------------------------------------------------------------------- */

static char *mark_path(const struct postgres_restore *restore)
{
    return mem_printf("%s/postgres-restore", restore->folder);
}

static void keep_mark(const struct postgres_restore *restore)
{
    char *path = mark_path(restore), *text = mem_printf("%d\n", restore->next_month);
    struct atomic_file file;
    int error = atomic_file_begin(&file, path, 0600);
    if (!error) {
        error = atomic_file_write(&file, text, strlen(text));
        if (!error)
            error = atomic_file_commit(&file, true);
        atomic_file_abandon(&file);
    }
    if (error)
        log_err(restore->log, "%s: cannot be written: %s", path, strerror(-error));
    mem_free(text);
    mem_free(path);
}

void postgres_restore_init(struct postgres_restore *restore, struct log *log, const struct plant *plant, const struct history_tag *tags,
                           const char *folder)
{
    size_t count, bytes;
    *restore = (struct postgres_restore){ .log = log, .plant = plant, .tags = tags, .folder = folder, .next_month = INT_MAX };
    char *path = mark_path(restore), *text = text_read_file(path, MARK_BYTES, &bytes);
    mem_free(month_list(folder, &count));
    restore->wanted = text || !count;
    if (text)
        restore->next_month = atoi(text);
    else if (!count && (mkdir(folder, 0777) == 0 || errno == EEXIST))
        keep_mark(restore);
    mem_free(text);
    mem_free(path);
}

static void end(struct postgres_restore *restore)
{
    char *path = mark_path(restore);
    unlink(path);
    mem_free(path);
    restore->wanted = false;
    if (restore->points)
        log_info(restore->log, "history: restored %lld points from PostgreSQL", (long long)restore->points);
}

/* --- ending lines in the database --------------------------------------------------------------------------------------------- */

/* Ends each tag's recorded line in the database, as month_file_recover() does in files: adds a point without a value 1 us after
   the tag's last point. Before that, the sender's newest samples (table `newest`) become points, too. They are added even
   before later points, because a standby may already have sent its first points. */
bool postgres_restore_end_lines(struct postgres_tables *tables, int64_t now_us)
{
    static const char sql[] =
        "BEGIN;"
        "INSERT INTO sample SELECT n.* FROM newest n JOIN tag g ON g.id = n.tag WHERE g.plant = %1$d ON CONFLICT DO NOTHING;"
        "DELETE FROM newest USING tag g WHERE g.id = newest.tag AND g.plant = %1$d;"
        "INSERT INTO event SELECT %1$d, t, 'gap', format('not recorded for %%s s',"
        " extract(epoch FROM 'epoch'::timestamptz + %3$lld * interval '1 microsecond' - t)::numeric(14, 1))"
        " FROM (SELECT max(l.t) AS t FROM tag g,"
        " LATERAL (SELECT t FROM sample WHERE tag = g.id ORDER BY t DESC LIMIT 1) l WHERE g.plant = %1$d) x WHERE t IS NOT NULL"
        " ON CONFLICT DO NOTHING;"
        "INSERT INTO sample SELECT g.id, l.t + interval '1 microsecond', NULL, %2$u FROM tag g,"
        " LATERAL (SELECT t, q FROM sample WHERE tag = g.id ORDER BY t DESC LIMIT 1) l WHERE g.plant = %1$d AND l.q <> %2$u;"
        "COMMIT";
    return postgres_link_runf(tables->link, sql, tables->plant, QUALITY_BAD_NO_COMMUNICATION, (long long)now_us);
}

/* Corrects the ends of recorded lines within a time span. This daemon wrote a gap mark after the last point that it knew. If
   the former leader continued the line, deletes that mark and writes one after the true last point. */
bool postgres_restore_end_span(struct postgres_tables *tables, int64_t from_us, int64_t to_us)
{
#define AT(US) "('epoch'::timestamptz + " US " * interval '1 microsecond')"
    static const char sql[] =
        "BEGIN;"
        "DELETE FROM sample s USING tag g WHERE g.id = s.tag AND g.plant = %1$d AND s.q = %2$u"
        " AND s.t > " AT("%3$lld") " AND s.t < " AT("%4$lld") " AND (s.t = " AT(
            "(%3$lld + 1)") " OR EXISTS (SELECT FROM sample b WHERE b.tag = s.tag AND b.t = s.t - interval '1 microsecond'))"
                            " AND EXISTS (SELECT FROM sample n WHERE n.tag = s.tag AND n.t > s.t AND n.t < " AT(
                                "%4$lld") ");"
                                          "INSERT INTO sample SELECT g.id, l.t + interval '1 microsecond', NULL, %2$u FROM tag g,"
                                          " LATERAL (SELECT t, q FROM sample WHERE tag = g.id AND t < " AT(
                                              "%4$lld") " ORDER BY t DESC LIMIT 1) l"
                                                        " WHERE g.plant = %1$d AND l.t > " AT(
                                                            "%3$lld") " AND l.q <> %2$u ON CONFLICT DO NOTHING;"
                                                                      "COMMIT";
#undef AT
    return postgres_link_runf(tables->link, sql, tables->plant, QUALITY_BAD_NO_COMMUNICATION, (long long)from_us, (long long)to_us);
}

/* Sets *first and *last to the first and the last month with points in the database; *any is false if there are none. Returns
   false if the query failed. */
static bool find_months(struct postgres_tables *tables, int *first, int *last, bool *any)
{
    char plant[NUMBER_BYTES];
    snprintf(plant, sizeof(plant), "%d", tables->plant);
    PGresult *span = postgres_link_ask(tables->link,
                                       "SELECT min(f.t), max(l.t) FROM tag g,"
                                       " LATERAL (SELECT t FROM sample WHERE tag = g.id ORDER BY t LIMIT 1) f,"
                                       " LATERAL (SELECT t FROM sample WHERE tag = g.id ORDER BY t DESC LIMIT 1) l"
                                       " WHERE g.plant = $1::int",
                                       1, (const char *[]){ plant });
    if (!span)
        return false;
    *any = PQntuples(span) && !PQgetisnull(span, 0, 0);
    if (*any) {
        *first = month_of(postgres_time(span, 0, 0));
        *last = month_of(postgres_time(span, 0, 1));
    }
    PQclear(span);
    return true;
}

/* --- restoring a month -------------------------------------------------------------------------------------------------------- */

struct tag_there {
    int32_t id;
    int tag; /* index of the plant's tag to whose history the points are restored */
    struct unit_change change;
};

static bool fail(char why[POSTGRES_WHY_BYTES], int error)
{
    snprintf(why, POSTGRES_WHY_BYTES, "the history files cannot be written: %s", database_error_text(error));
    return false;
}

/* Copies the points of one tag up to the end of a month from the database to the month's file. Each query returns at most
   POINTS_AT_ONCE points, which bounds the memory. */
static bool restore_tag(struct postgres_tables *tables, const struct tag_there *there, struct month_file *file, int64_t after_us,
                        int64_t end_us, int64_t *points, char why[POSTGRES_WHY_BYTES])
{
    char id[NUMBER_BYTES], after[NUMBER_BYTES], end[NUMBER_BYTES], most[NUMBER_BYTES];
    int count = POINTS_AT_ONCE, error = 0;
    snprintf(id, sizeof(id), "%d", there->id);
    snprintf(end, sizeof(end), "%lld", (long long)end_us);
    snprintf(most, sizeof(most), "%d", POINTS_AT_ONCE);
    while (count == POINTS_AT_ONCE && !error) {
        snprintf(after, sizeof(after), "%lld", (long long)after_us);
        PGresult *rows = postgres_link_ask(tables->link,
                                           "SELECT t, v, q FROM sample WHERE tag = $1::int"
                                           " AND t > 'epoch'::timestamptz + $2::bigint * interval '1 microsecond'"
                                           " AND t < 'epoch'::timestamptz + $3::bigint * interval '1 microsecond'"
                                           " ORDER BY t LIMIT $4::int",
                                           4, (const char *[]){ id, after, end, most });
        if (!rows)
            return false;
        count = PQntuples(rows);
        struct history_point *at = mem_array((size_t)count + 1, sizeof(*at));
        for (int i = 0; i < count; i++)
            at[i] = (struct history_point){ postgres_time(rows, i, 0), unit_change_value(&there->change, postgres_double(rows, i, 1)),
                                            (uint32_t)postgres_int64(rows, i, 2) };
        if (count)
            after_us = at[count - 1].t_us;
        error = month_file_import(file, there->tag, at, (size_t)count);
        *points += count;
        mem_free(at);
        PQclear(rows);
    }
    return !error || fail(why, error);
}

static bool restore_events(struct postgres_tables *tables, struct month_file *file, char why[POSTGRES_WHY_BYTES])
{
    char plant[NUMBER_BYTES], month[2][NUMBER_BYTES];
    int error = 0;
    snprintf(plant, sizeof(plant), "%d", tables->plant);
    for (int i = 0; i < 2; i++)
        snprintf(month[i], sizeof(month[i]), "%lld", (long long)(month_begin_us(month_file_month(file) + i) / US_PER_S));
    PGresult *rows = postgres_link_ask(tables->link,
                                       "SELECT t, kind, text FROM event WHERE plant = $1::int AND t >= to_timestamp($2::bigint)"
                                       " AND t < to_timestamp($3::bigint)",
                                       3, (const char *[]){ plant, month[0], month[1] });
    for (int i = 0; rows && i < PQntuples(rows) && !error; i++)
        error = month_file_note(file, postgres_time(rows, i, 0), PQgetvalue(rows, i, 1), PQgetvalue(rows, i, 2));
    PQclear(rows);
    return rows && (!error || fail(why, error));
}

/* Finds the tags in the database that this plant also has, by name, and whose unit can be converted to the tag's current unit.
   Returns an array of *count elements (free with mem_free()); NULL if the query failed. */
static struct tag_there *find_tags(const struct postgres_restore *restore, struct postgres_tables *tables, size_t *count)
{
    char plant[NUMBER_BYTES];
    snprintf(plant, sizeof(plant), "%d", tables->plant);
    PGresult *rows = postgres_link_ask(tables->link, "SELECT id, name, unit FROM tag WHERE plant = $1::int", 1, (const char *[]){ plant });
    struct tag_there *found = rows ? mem_array((size_t)PQntuples(rows) + 1, sizeof(*found)) : NULL;
    *count = 0;
    for (int i = 0; rows && i < PQntuples(rows); i++) {
        struct tag_there there = { postgres_int32(rows, i, 0), plant_find_tag(restore->plant, PQgetvalue(rows, i, 1)), { 0 } };
        if (there.tag >= 0 && history_unit_fits(PQgetvalue(rows, i, 2), restore->tags[there.tag].unit, &there.change))
            found[(*count)++] = there;
    }
    PQclear(rows);
    return found;
}

/* Sets *any to true if the database has points of the plant between two times. Returns false if the query failed. */
static bool find_points(struct postgres_tables *tables, int64_t from_us, int64_t to_us, bool *any)
{
    char plant[NUMBER_BYTES], from[NUMBER_BYTES], to[NUMBER_BYTES];
    snprintf(plant, sizeof(plant), "%d", tables->plant);
    snprintf(from, sizeof(from), "%lld", (long long)from_us);
    snprintf(to, sizeof(to), "%lld", (long long)to_us);
    PGresult *rows = postgres_link_ask(tables->link,
                                       "SELECT 1 FROM tag g WHERE g.plant = $1::int AND EXISTS (SELECT FROM sample WHERE tag = g.id"
                                       " AND t > 'epoch'::timestamptz + $2::bigint * interval '1 microsecond'"
                                       " AND t < 'epoch'::timestamptz + $3::bigint * interval '1 microsecond') LIMIT 1",
                                       3, (const char *[]){ plant, from, to });
    *any = rows && PQntuples(rows);
    PQclear(rows);
    return rows;
}

/* Opens the file of a month. *file is NULL if there is neither a file nor any point in the database for that month. Returns
   false if the query or the file failed. */
static bool open_month(const struct postgres_restore *restore, struct postgres_tables *tables, int month, int64_t from_us, int64_t to_us,
                       struct month_file **file, char why[POSTGRES_WHY_BYTES])
{
    char name[MONTH_NAME_BYTES];
    month_name(month, name);
    char *path = mem_printf("%s/%s", restore->folder, name);
    bool wanted = access(path, F_OK) == 0;
    mem_free(path);
    *file = NULL;
    if (!wanted && !find_points(tables, from_us, to_us, &wanted))
        return false;
    int error = 0;
    if (wanted)
        *file = month_file_open(restore->log, restore->folder, month, restore->tags, restore->plant->tag_count, &error);
    return !error || fail(why, error);
}

static bool restore_month(struct postgres_restore *restore, struct postgres_tables *tables, int month, int64_t *points,
                          char why[POSTGRES_WHY_BYTES])
{
    int64_t from_us = month_begin_us(month) - 1, to_us = month_begin_us(month + 1);
    size_t count;
    struct month_file *file;
    struct tag_there *found = find_tags(restore, tables, &count);
    if (!found)
        return false;
    bool good = open_month(restore, tables, month, from_us, to_us, &file, why);
    for (size_t i = 0; i < count && good && file; i++)
        good = restore_tag(tables, &found[i], file, from_us, to_us, points, why);
    good = good && (!file || restore_events(tables, file, why));
    month_file_close(&file);
    mem_free(found);
    return good;
}

static bool restore_span_of_month(struct postgres_restore *restore, struct postgres_tables *tables, struct month_file *file,
                                  int64_t from_us, int64_t to_us, int64_t *points, char why[POSTGRES_WHY_BYTES])
{
    size_t count;
    struct tag_there *found = find_tags(restore, tables, &count);
    int error = found ? month_file_forget_gaps(file, from_us, to_us, QUALITY_BAD_NO_COMMUNICATION) : 0;
    bool good = found && (!error || fail(why, error));
    for (size_t i = 0; i < count && good; i++)
        good = restore_tag(tables, &found[i], file, from_us, to_us, points, why);
    mem_free(found);
    return good;
}

bool postgres_restore_span(struct postgres_restore *restore, struct postgres_tables *tables, int64_t from_us, int64_t to_us,
                           int64_t *points, char why[POSTGRES_WHY_BYTES])
{
    bool good = true;
    *points = 0;
    for (int month = month_of(from_us); month <= month_of(to_us) && good; month++) {
        int64_t begin_us = month_begin_us(month) - 1, end_us = month_begin_us(month + 1);
        int64_t after_us = from_us > begin_us ? from_us : begin_us, until_us = to_us < end_us ? to_us : end_us;
        struct month_file *file;
        good = open_month(restore, tables, month, after_us, until_us, &file, why);
        if (file)
            good = restore_span_of_month(restore, tables, file, after_us, until_us, points, why);
        month_file_close(&file);
    }
    return good;
}

bool postgres_restore_step(struct postgres_restore *restore, struct postgres_tables *tables, int64_t now_us, int64_t *points,
                           char why[POSTGRES_WHY_BYTES])
{
    int first = 0, last = 0, oldest = month_of(now_us - (int64_t)(restore->plant->history.keep_days * 86400 * US_PER_S));
    bool any;
    *points = 0;
    if ((restore->next_month == INT_MAX && !restore->begins && !postgres_restore_end_lines(tables, now_us)) ||
        !find_months(tables, &first, &last, &any))
        return false;
    int month = restore->next_month < last ? restore->next_month : last;
    if (!any || month < first || month < oldest) {
        end(restore);
        return true;
    }
    if (!restore_month(restore, tables, month, points, why))
        return false;
    restore->points += *points;
    restore->next_month = month - 1;
    keep_mark(restore);
    return true;
}
