/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The alarm journal's SQLite tables: one row for each change of an alarm, and the current state of each alarm. */
#include "alarm/journal_file.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

#include "base/files/database.h"
#include "base/mem.h"

enum { APPLICATION_ID = 0x5043414A /* the letters PCAJ, which identify a journal among SQLite files */ };

static const char schema_1[] =
    "CREATE TABLE event(id INTEGER PRIMARY KEY AUTOINCREMENT, t INTEGER NOT NULL, tag TEXT NOT NULL, kind TEXT NOT NULL,"
    " event TEXT NOT NULL, before TEXT NOT NULL, after TEXT NOT NULL, priority INTEGER NOT NULL, lim REAL, value REAL,"
    " who TEXT NOT NULL, reason TEXT NOT NULL);"
    "CREATE INDEX event_t ON event(t);"
    "CREATE INDEX event_tag ON event(tag, kind, t);"
    "CREATE TABLE state(tag TEXT NOT NULL, kind TEXT NOT NULL, active INTEGER NOT NULL, unacknowledged INTEGER NOT NULL,"
    " latched INTEGER NOT NULL, aside INTEGER NOT NULL, value REAL, raised INTEGER NOT NULL, changed INTEGER NOT NULL,"
    " until INTEGER NOT NULL, who TEXT NOT NULL, reason TEXT NOT NULL, PRIMARY KEY(tag, kind)) WITHOUT ROWID;"
    "CREATE VIEW journal AS SELECT strftime('%Y-%m-%dT%H:%M:%fZ', t / 1e6, 'unixepoch') AS utc, tag, kind, event, after AS state,"
    " priority, lim AS \"limit\", value, who, reason FROM event;";
/* Version 2 of the file format adds the unit of each row's value. Rows written before have no unit (NULL), because it is not
   known. */
static const char schema_2[] =
    "ALTER TABLE event ADD COLUMN unit TEXT;"
    "ALTER TABLE state ADD COLUMN unit TEXT;"
    "DROP VIEW journal;"
    "CREATE VIEW journal AS SELECT strftime('%Y-%m-%dT%H:%M:%fZ', t / 1e6, 'unixepoch') AS utc, tag, kind, event, after AS state,"
    " priority, lim AS \"limit\", value, unit, who, reason FROM event;";
static const char *const schemas[JOURNAL_VERSION] = { schema_1, schema_2 };

#define ROW(unit) "id, t, tag, kind, event, before, after, priority, lim, value, who, reason, " unit
/* Reads rows in the order of the time index, so that a page of old rows takes no longer to read than a page of new ones. */
#define IN_TIME(unit) "SELECT " ROW(unit) " FROM event WHERE t BETWEEN ?1 AND ?2 AND (t < ?3 OR id < ?4)"
#define NEWEST " ORDER BY t DESC, id DESC LIMIT ?5"
/* Query for the newest row of each alarm up to a given time. It jumps from alarm to alarm in the index on tag and kind, which
   takes a few steps for each alarm, however long the journal is. */
#define AT(unit)                                                                                                                           \
    "WITH RECURSIVE known(tag, kind) AS ("                                                                                                 \
    " SELECT * FROM (SELECT tag, kind FROM event ORDER BY tag, kind LIMIT 1)"                                                              \
    " UNION ALL SELECT next.tag, next.kind FROM known JOIN event next ON next.id ="                                                        \
    " coalesce((SELECT id FROM event WHERE tag = known.tag AND kind > known.kind ORDER BY kind LIMIT 1),"                                  \
    " (SELECT id FROM event WHERE tag > known.tag ORDER BY tag, kind LIMIT 1))) "                                                          \
    "SELECT " ROW(unit) " FROM event WHERE id IN (SELECT (SELECT id FROM event WHERE tag = known.tag AND kind = known.kind AND t <= ?1"    \
    " ORDER BY t DESC, id DESC LIMIT 1) FROM known) AND after <> 'normal' ORDER BY id"
#define STATES(unit)                                                                                                                       \
    "SELECT tag, kind, active, unacknowledged, latched, aside, value, raised, changed, until, who, reason, " unit " FROM state"
/* SQL_STATES_1 and other names that end in _1: the same queries for a file of format version 1, which has no unit column. */
enum {
    SQL_EVENT, SQL_STATE, SQL_NORMAL, SQL_FORGET, SQL_TIME_OF, SQL_HAS_UNIT,
    SQL_STATES, SQL_ROWS, SQL_ROWS_OF, SQL_AT, SQL_STATES_1, SQL_ROWS_1, SQL_ROWS_OF_1, SQL_AT_1, SQL_COUNT
};
static const char *const sql[SQL_COUNT] = {
    /* Skips a row that the journal already has: a leader resends rows whenever a standby connects. For priority 0, takes the priority
       from the alarm's newest row, or the lowest one if that row has been deleted */
    [SQL_EVENT] = "INSERT INTO event(t, tag, kind, event, before, after, priority, lim, value, who, reason, unit)"
                  " SELECT ?1, ?2, ?3, ?4, ?5, ?6, coalesce(nullif(?7, 0), (SELECT priority FROM event WHERE tag = ?2 AND kind = ?3"
                  " ORDER BY t DESC, id DESC LIMIT 1), 4), ?8, ?9, ?10, ?11, ?12 WHERE NOT EXISTS (SELECT 1 FROM event WHERE tag = ?2"
                  " AND kind = ?3 AND t = ?1 AND event = ?4 AND before = ?5 AND after = ?6 AND value IS ?9)",
    [SQL_STATE] = "INSERT OR REPLACE INTO state(tag, kind, active, unacknowledged, latched, aside, value, raised, changed, until, who,"
                  " reason, unit) VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
    [SQL_NORMAL] = "DELETE FROM state WHERE tag = ? AND kind = ?",
    [SQL_FORGET] = "DELETE FROM event WHERE t < ?",
    [SQL_TIME_OF] = "SELECT t FROM event WHERE id = ?",
    [SQL_HAS_UNIT] = "SELECT 1 FROM pragma_table_info('event') WHERE name = 'unit'",
    [SQL_STATES] = STATES("unit"),
    [SQL_ROWS] = IN_TIME("unit") NEWEST,
    [SQL_ROWS_OF] = IN_TIME("unit") " AND tag = ?6" NEWEST,
    [SQL_AT] = AT("unit"),
    [SQL_STATES_1] = STATES("NULL"),
    [SQL_ROWS_1] = IN_TIME("NULL") NEWEST,
    [SQL_ROWS_OF_1] = IN_TIME("NULL") " AND tag = ?6" NEWEST,
    [SQL_AT_1] = AT("NULL"),
};
static const struct database_format format = { APPLICATION_ID, JOURNAL_VERSION, "", schemas, sql, SQL_COUNT };

struct journal_file {
    struct database db;
    bool has_unit; /* false: a version 1 file, which has no unit column, opened for reading */
};

/* --- opening ---------------------------------------------------------------------------------------------------------------- */

static struct journal_file *create(struct log *log, const char *folder)
{
    struct journal_file *file = mem_new(sizeof(*file));
    database_init(&file->db, log, mem_printf("%s/" JOURNAL_FILE, folder), &format);
    file->has_unit = true;
    return file;
}

struct journal_file *journal_file_open(struct log *log, const char *folder, bool *renewed, int *error)
{
    struct journal_file *file = create(log, folder);
    if (mkdir(folder, 0777) != 0 && errno != EEXIST)
        log_lasting_err(log, "%s: cannot be created: %s", folder, strerror(errno));
    *error = database_open(&file->db, renewed);
    if (*error)
        journal_file_close(&file);
    return file;
}

struct journal_file *journal_file_read(struct log *log, const char *folder, int *error)
{
    struct journal_file *file = create(log, folder);
    *error = database_open_to_read(&file->db);
    if (*error) {
        journal_file_close(&file);
    } else {
        sqlite3_stmt *s = database_statement(&file->db, SQL_HAS_UNIT);
        file->has_unit = database_step(&file->db, s) == SQLITE_ROW;
        sqlite3_reset(s);
    }
    if (*error == -ENOENT)
        *error = 0;
    return file;
}

void journal_file_close(struct journal_file **file)
{
    if (!*file)
        return;
    database_finish(&(*file)->db);
    mem_free(*file);
    *file = NULL;
}

/* --- writing ---------------------------------------------------------------------------------------------------------------- */

static void bind_unit(sqlite3_stmt *s, int index, const struct journal_entry *entry)
{
    if (entry->has_unit)
        database_bind_text(s, index, entry->unit);
    else
        sqlite3_bind_null(s, index);
}

static int write_event(struct journal_file *file, const struct journal_entry *entry)
{
    sqlite3_stmt *s = database_statement(&file->db, SQL_EVENT);
    sqlite3_bind_int64(s, 1, entry->utc_ns / 1000);
    database_bind_text(s, 2, entry->tag);
    database_bind_text(s, 3, alarm_kind_name(entry->alarm.kind));
    database_bind_text(s, 4, alarm_event_name(entry->event));
    database_bind_text(s, 5, alarm_status_name(entry->before));
    database_bind_text(s, 6, alarm_status_name(entry->after));
    sqlite3_bind_int(s, 7, entry->alarm.priority);
    database_bind_value(s, 8, entry->alarm.limit);
    database_bind_value(s, 9, entry->value);
    database_bind_text(s, 10, entry->who);
    database_bind_text(s, 11, entry->reason);
    bind_unit(s, 12, entry);
    return database_run(&file->db, s);
}

static int write_state(struct journal_file *file, const struct journal_entry *entry)
{
    const struct alarm *alarm = &entry->alarm;
    bool normal = alarm_status_of(alarm) == ALARM_NORMAL;
    sqlite3_stmt *s = database_statement(&file->db, normal ? SQL_NORMAL : SQL_STATE);
    database_bind_text(s, 1, entry->tag);
    database_bind_text(s, 2, alarm_kind_name(alarm->kind));
    if (!normal) {
        sqlite3_bind_int(s, 3, alarm->state.active);
        sqlite3_bind_int(s, 4, alarm->state.unacknowledged);
        sqlite3_bind_int(s, 5, alarm->state.latched);
        sqlite3_bind_int(s, 6, alarm->state.aside);
        database_bind_value(s, 7, alarm->value);
        sqlite3_bind_int64(s, 8, alarm->raised_utc_ns / 1000);
        sqlite3_bind_int64(s, 9, alarm->changed_utc_ns / 1000);
        sqlite3_bind_int64(s, 10, alarm->until.utc_ns / 1000);
        database_bind_text(s, 11, alarm->who);
        database_bind_text(s, 12, alarm->reason);
        bind_unit(s, 13, entry);
    }
    return database_run(&file->db, s);
}

int journal_file_write(struct journal_file *file, const struct journal_entry *entries, size_t count)
{
    int code = sqlite3_exec(file->db.handle, "BEGIN IMMEDIATE", NULL, NULL, NULL);
    if (!count && code == SQLITE_OK) {
        /* writes a page, because a transaction without changes succeeds even on a full disk */
        char *stamp = mem_printf("PRAGMA user_version = %d", file->db.format->version);
        code = sqlite3_exec(file->db.handle, stamp, NULL, NULL, NULL);
        mem_free(stamp);
    }
    for (size_t i = 0; i < count && code == SQLITE_OK; i++) {
        if (entries[i].changed)
            code = write_event(file, &entries[i]);
        if (code == SQLITE_OK)
            code = write_state(file, &entries[i]);
    }
    if (code == SQLITE_OK)
        code = sqlite3_exec(file->db.handle, "COMMIT", NULL, NULL, NULL);
    int error = database_fail(&file->db, code, "cannot be written");
    if (error)
        sqlite3_exec(file->db.handle, "ROLLBACK", NULL, NULL, NULL);
    return error;
}

int journal_file_forget(struct journal_file *file, int64_t before_us)
{
    sqlite3_stmt *s = database_statement(&file->db, SQL_FORGET);
    sqlite3_bind_int64(s, 1, before_us);
    return database_fail(&file->db, database_run(&file->db, s),
                         "alarm events older than keep_days cannot be deleted from the alarm journal");
}

/* --- reading ---------------------------------------------------------------------------------------------------------------- */

/* Returns the statement SQL_STATES, SQL_ROWS, SQL_ROWS_OF or SQL_AT in the form for the file's version. */
static sqlite3_stmt *reading(struct journal_file *file, int which)
{
    return database_statement(&file->db, file->has_unit ? which : which - SQL_STATES + SQL_STATES_1);
}

/* Returns the text in a column; NULL: the column is NULL. */
static const char *text_or_null(sqlite3_stmt *s, int column)
{
    return (const char *)sqlite3_column_text(s, column);
}

int journal_file_states(struct journal_file *file,
                        void (*each)(void *arg, const char *tag, const char *unit, const struct alarm *alarm), void *arg)
{
    sqlite3_stmt *s = reading(file, SQL_STATES);
    int code;
    while ((code = database_step(&file->db, s)) == SQLITE_ROW) {
        struct alarm alarm = {
            .kind = alarm_kind_find(database_text(s, 1)),
            .state = { sqlite3_column_int(s, 2) != 0, sqlite3_column_int(s, 3) != 0, sqlite3_column_int(s, 4) != 0,
                       (uint8_t)(sqlite3_column_int(s, 5) & ALARM_ASIDE_ALL) },
            .value = database_value(s, 6),
            .raised_utc_ns = sqlite3_column_int64(s, 7) * 1000,
            .changed_utc_ns = sqlite3_column_int64(s, 8) * 1000,
            .until.utc_ns = sqlite3_column_int64(s, 9) * 1000,
        };
        strncpy(alarm.who, database_text(s, 10), sizeof(alarm.who) - 1);
        strncpy(alarm.reason, database_text(s, 11), sizeof(alarm.reason) - 1);
        each(arg, database_text(s, 0), text_or_null(s, 12), &alarm);
    }
    sqlite3_reset(s);
    return database_fail(&file->db, code, "cannot be read");
}

static void tell(sqlite3_stmt *s, void (*each)(void *arg, const struct journal_row *row), void *arg)
{
    const struct journal_row row = {
        .id = sqlite3_column_int64(s, 0),
        .t_us = sqlite3_column_int64(s, 1),
        .tag = database_text(s, 2),
        .kind = database_text(s, 3),
        .event = database_text(s, 4),
        .before = database_text(s, 5),
        .after = database_text(s, 6),
        .priority = sqlite3_column_int(s, 7),
        .limit = database_value(s, 8),
        .value = database_value(s, 9),
        .who = database_text(s, 10),
        .reason = database_text(s, 11),
        .unit = text_or_null(s, 12),
    };
    each(arg, &row);
}

/* Returns the time of the journal row with that id; INT64_MIN: there is none, for example because it was deleted. */
static int64_t time_of(struct journal_file *file, int64_t id)
{
    sqlite3_stmt *s = database_statement(&file->db, SQL_TIME_OF);
    sqlite3_bind_int64(s, 1, id);
    int64_t t_us = database_step(&file->db, s) == SQLITE_ROW ? sqlite3_column_int64(s, 0) : INT64_MIN;
    sqlite3_reset(s);
    return t_us;
}

static int tell_all(struct journal_file *file, sqlite3_stmt *s, void (*each)(void *arg, const struct journal_row *row), void *arg)
{
    int code;
    while ((code = database_step(&file->db, s)) == SQLITE_ROW)
        tell(s, each, arg);
    sqlite3_reset(s);
    return database_fail(&file->db, code, "cannot be read");
}

int journal_file_rows(struct journal_file *file, const struct journal_query *query, void (*each)(void *arg, const struct journal_row *row),
                      void *arg)
{
    int64_t before_us = query->before_id == INT64_MAX ? INT64_MIN : time_of(file, query->before_id), to_us = query->to_us;
    sqlite3_stmt *s = reading(file, query->tag ? SQL_ROWS_OF : SQL_ROWS);
    if (before_us != INT64_MIN && before_us < to_us)
        to_us = before_us;
    sqlite3_bind_int64(s, 1, query->from_us);
    sqlite3_bind_int64(s, 2, to_us);
    sqlite3_bind_int64(s, 3, before_us);
    sqlite3_bind_int64(s, 4, query->before_id);
    sqlite3_bind_int(s, 5, query->limit);
    if (query->tag)
        database_bind_text(s, 6, query->tag);
    return tell_all(file, s, each, arg);
}

int journal_file_at(struct journal_file *file, int64_t t_us, void (*each)(void *arg, const struct journal_row *row), void *arg)
{
    sqlite3_stmt *s = reading(file, SQL_AT);
    sqlite3_bind_int64(s, 1, t_us);
    return tell_all(file, s, each, arg);
}
