/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The journal's tables: one row for each change, and how each alarm is. */
#include "alarm/journal_file.h"

#include <errno.h>
#include <math.h>
#include <sqlite3.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/damaged.h"
#include "base/mem.h"

enum { APPLICATION_ID = 0x5043414A /* "PCAJ" */, BUSY_MS = 5000 };

static const char schema[] =
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

enum { SQL_EVENT, SQL_STATE, SQL_NORMAL, SQL_FORGET, SQL_COUNT };
static const char *const sql[SQL_COUNT] = {
    [SQL_EVENT] = "INSERT INTO event(t, tag, kind, event, before, after, priority, lim, value, who, reason)"
                  " VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
    [SQL_STATE] = "INSERT OR REPLACE INTO state(tag, kind, active, unacknowledged, latched, aside, value, raised, changed, until, who,"
                  " reason) VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
    [SQL_NORMAL] = "DELETE FROM state WHERE tag = ? AND kind = ?",
    [SQL_FORGET] = "DELETE FROM event WHERE t < ?",
};
#define ROW "id, t, tag, kind, event, before, after, priority, lim, value, who, reason"

struct journal_file {
    struct log *log;
    char *path;
    sqlite3 *db;
    sqlite3_stmt *statements[SQL_COUNT];
};

static int errno_of(int code)
{
    switch (code & 0xff) {
    case SQLITE_FULL: return ENOSPC;
    case SQLITE_READONLY: return EROFS;
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB: return EBADMSG;
    case SQLITE_BUSY:
    case SQLITE_LOCKED: return EBUSY;
    case SQLITE_CANTOPEN:
    case SQLITE_PERM: return EACCES;
    default: return EIO;
    }
}

static int fail(struct journal_file *file, int code, const char *doing)
{
    if (code == SQLITE_OK || code == SQLITE_DONE || code == SQLITE_ROW)
        return 0;
    bool told = file->db && sqlite3_errcode(file->db) != SQLITE_OK;
    log_err(file->log, "%s: %s: %s", file->path, doing, told ? sqlite3_errmsg(file->db) : sqlite3_errstr(code));
    return -errno_of(code);
}

/* --- opening ---------------------------------------------------------------------------------------------------------------- */

static int version_of(sqlite3 *db, int *version)
{
    sqlite3_stmt *statement = NULL;
    int code = sqlite3_prepare_v2(db, "PRAGMA user_version", -1, &statement, NULL);
    if (code == SQLITE_OK && (code = sqlite3_step(statement)) == SQLITE_ROW)
        *version = sqlite3_column_int(statement, 0);
    sqlite3_finalize(statement);
    return code == SQLITE_ROW ? SQLITE_OK : code;
}

static int open_database(struct journal_file *file, int flags)
{
    int code = sqlite3_open_v2(file->path, &file->db, flags | SQLITE_OPEN_NOMUTEX, NULL);
    if (code == SQLITE_OK)
        sqlite3_busy_timeout(file->db, BUSY_MS);
    return code;
}

static int check_version(struct journal_file *file, int *version)
{
    int code = version_of(file->db, version);
    if (code != SQLITE_OK || *version <= JOURNAL_VERSION)
        return code;
    log_err(file->log, "%s: version %d is a newer Plantcast's; this program knows version %d", file->path, *version, JOURNAL_VERSION);
    return SQLITE_PERM;
}

static int make_tables(struct journal_file *file)
{
    char *stamp = mem_printf("BEGIN IMMEDIATE; %s PRAGMA user_version = %d; PRAGMA application_id = %d; COMMIT", schema, JOURNAL_VERSION,
                             APPLICATION_ID);
    int code = sqlite3_exec(file->db, stamp, NULL, NULL, NULL);
    mem_free(stamp);
    return code;
}

static int open_to_write(struct journal_file *file)
{
    int version = 0, code = open_database(file, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
    if (code == SQLITE_OK)
        code = sqlite3_exec(file->db, "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL", NULL, NULL, NULL);
    if (code == SQLITE_OK)
        code = check_version(file, &version);
    return code == SQLITE_OK && version == 0 ? make_tables(file) : code;
}

static void close_database(struct journal_file *file)
{
    for (int i = 0; i < SQL_COUNT; i++) {
        sqlite3_finalize(file->statements[i]);
        file->statements[i] = NULL;
    }
    sqlite3_close(file->db);
    file->db = NULL;
}

static bool set_aside(struct journal_file *file)
{
    close_database(file);
    return damaged_set_aside(file->log, file->path);
}

static struct journal_file *create(struct log *log, const char *folder)
{
    struct journal_file *file = mem_new(sizeof(*file));
    file->log = log;
    file->path = mem_printf("%s/" JOURNAL_FILE, folder);
    return file;
}

struct journal_file *journal_file_open(struct log *log, const char *folder, bool *renewed, int *error)
{
    struct journal_file *file = create(log, folder);
    *renewed = false;
    if (mkdir(folder, 0777) != 0 && errno != EEXIST)
        log_err(log, "%s: cannot be made: %s", folder, strerror(errno));
    int code = open_to_write(file);
    if (code != SQLITE_OK && errno_of(code) == EBADMSG && set_aside(file)) {
        *renewed = true;
        code = open_to_write(file);
    }
    *error = fail(file, code, "cannot be opened");
    if (*error)
        journal_file_close(&file);
    return file;
}

struct journal_file *journal_file_read(struct log *log, const char *folder, int *error)
{
    struct journal_file *file = create(log, folder);
    int version = 0;
    *error = 0;
    if (access(file->path, F_OK) != 0)
        goto none;
    int code = open_database(file, SQLITE_OPEN_READONLY);
    if (code == SQLITE_OK)
        code = check_version(file, &version);
    *error = fail(file, code, "cannot be read");
    if (!*error && version == JOURNAL_VERSION)
        return file;
none:
    journal_file_close(&file);
    return NULL;
}

void journal_file_close(struct journal_file **file)
{
    if (!*file)
        return;
    close_database(*file);
    mem_free((*file)->path);
    mem_free(*file);
    *file = NULL;
}

/* --- writing ---------------------------------------------------------------------------------------------------------------- */

static sqlite3_stmt *prepared(struct journal_file *file, int which)
{
    sqlite3_stmt **statement = &file->statements[which];
    if (!*statement && sqlite3_prepare_v3(file->db, sql[which], -1, SQLITE_PREPARE_PERSISTENT, statement, NULL) != SQLITE_OK)
        return NULL;
    sqlite3_reset(*statement);
    return *statement;
}

static int run(struct journal_file *file, sqlite3_stmt *statement)
{
    if (!statement)
        return sqlite3_errcode(file->db);
    int code = sqlite3_step(statement);
    sqlite3_reset(statement);
    return code == SQLITE_DONE ? SQLITE_OK : code;
}

static void bind_text(sqlite3_stmt *statement, int index, const char *text)
{
    sqlite3_bind_text(statement, index, text, -1, SQLITE_STATIC);
}

static void bind_value(sqlite3_stmt *statement, int index, double value)
{
    if (isnan(value))
        sqlite3_bind_null(statement, index);
    else
        sqlite3_bind_double(statement, index, value);
}

static int write_event(struct journal_file *file, const struct journal_entry *entry)
{
    sqlite3_stmt *s = prepared(file, SQL_EVENT);
    sqlite3_bind_int64(s, 1, entry->utc_ns / 1000);
    bind_text(s, 2, entry->tag);
    bind_text(s, 3, alarm_kind_name(entry->alarm.kind));
    bind_text(s, 4, alarm_event_name(entry->event));
    bind_text(s, 5, alarm_word_name(entry->before));
    bind_text(s, 6, alarm_word_name(entry->after));
    sqlite3_bind_int(s, 7, entry->alarm.priority);
    bind_value(s, 8, entry->alarm.limit);
    bind_value(s, 9, entry->value);
    bind_text(s, 10, entry->who);
    bind_text(s, 11, entry->reason);
    return run(file, s);
}

static int write_state(struct journal_file *file, const struct journal_entry *entry)
{
    const struct alarm *alarm = &entry->alarm;
    bool normal = alarm_word_of(alarm) == ALARM_NORMAL;
    sqlite3_stmt *s = prepared(file, normal ? SQL_NORMAL : SQL_STATE);
    bind_text(s, 1, entry->tag);
    bind_text(s, 2, alarm_kind_name(alarm->kind));
    if (!normal) {
        sqlite3_bind_int(s, 3, alarm->state.active);
        sqlite3_bind_int(s, 4, alarm->state.unacknowledged);
        sqlite3_bind_int(s, 5, alarm->state.latched);
        sqlite3_bind_int(s, 6, alarm->state.aside);
        bind_value(s, 7, alarm->value);
        sqlite3_bind_int64(s, 8, alarm->raised_utc_ns / 1000);
        sqlite3_bind_int64(s, 9, alarm->changed_utc_ns / 1000);
        sqlite3_bind_int64(s, 10, alarm->until.utc_ns / 1000);
        bind_text(s, 11, alarm->who);
        bind_text(s, 12, alarm->reason);
    }
    return run(file, s);
}

int journal_file_write(struct journal_file *file, const struct journal_entry *entries, size_t count)
{
    int code = sqlite3_exec(file->db, "BEGIN IMMEDIATE", NULL, NULL, NULL);
    for (size_t i = 0; i < count && code == SQLITE_OK; i++) {
        if (entries[i].changed)
            code = write_event(file, &entries[i]);
        if (code == SQLITE_OK)
            code = write_state(file, &entries[i]);
    }
    if (code == SQLITE_OK)
        code = sqlite3_exec(file->db, "COMMIT", NULL, NULL, NULL);
    int error = fail(file, code, "cannot be written");
    if (error)
        sqlite3_exec(file->db, "ROLLBACK", NULL, NULL, NULL);
    return error;
}

int journal_file_forget(struct journal_file *file, int64_t before_us)
{
    sqlite3_stmt *s = prepared(file, SQL_FORGET);
    sqlite3_bind_int64(s, 1, before_us);
    return fail(file, run(file, s), "old rows cannot be deleted");
}

/* --- reading ---------------------------------------------------------------------------------------------------------------- */

static double value_at(sqlite3_stmt *s, int column)
{
    return sqlite3_column_type(s, column) == SQLITE_NULL ? NAN : sqlite3_column_double(s, column);
}

static const char *text_at(sqlite3_stmt *s, int column)
{
    const char *text = (const char *)sqlite3_column_text(s, column);
    return text ? text : "";
}

int journal_file_states(struct journal_file *file, void (*each)(void *arg, const char *tag, const struct alarm *alarm), void *arg)
{
    sqlite3_stmt *s = NULL;
    int code = sqlite3_prepare_v2(file->db,
                                  "SELECT tag, kind, active, unacknowledged, latched, aside, value, raised, changed, until, who, reason"
                                  " FROM state",
                                  -1, &s, NULL);
    while (code == SQLITE_OK || code == SQLITE_ROW) {
        if ((code = sqlite3_step(s)) != SQLITE_ROW)
            break;
        struct alarm alarm = {
            .kind = alarm_kind_find(text_at(s, 1)),
            .state = { sqlite3_column_int(s, 2) != 0, sqlite3_column_int(s, 3) != 0, sqlite3_column_int(s, 4) != 0,
                       (uint8_t)(sqlite3_column_int(s, 5) & ALARM_ASIDE_ALL) },
            .value = value_at(s, 6),
            .raised_utc_ns = sqlite3_column_int64(s, 7) * 1000,
            .changed_utc_ns = sqlite3_column_int64(s, 8) * 1000,
            .until.utc_ns = sqlite3_column_int64(s, 9) * 1000,
        };
        strncpy(alarm.who, text_at(s, 10), sizeof(alarm.who) - 1);
        strncpy(alarm.reason, text_at(s, 11), sizeof(alarm.reason) - 1);
        each(arg, text_at(s, 0), &alarm);
    }
    sqlite3_finalize(s);
    return fail(file, code, "cannot be read");
}

static void tell(sqlite3_stmt *s, void (*each)(void *arg, const struct journal_row *row), void *arg)
{
    const struct journal_row row = {
        .id = sqlite3_column_int64(s, 0),
        .t_us = sqlite3_column_int64(s, 1),
        .tag = text_at(s, 2),
        .kind = text_at(s, 3),
        .event = text_at(s, 4),
        .before = text_at(s, 5),
        .after = text_at(s, 6),
        .priority = sqlite3_column_int(s, 7),
        .limit = value_at(s, 8),
        .value = value_at(s, 9),
        .who = text_at(s, 10),
        .reason = text_at(s, 11),
    };
    each(arg, &row);
}

/* When a row was; INT64_MIN: it is not there any more. */
static int64_t time_of(struct journal_file *file, int64_t id)
{
    sqlite3_stmt *s = NULL;
    int64_t t_us = INT64_MIN;
    if (sqlite3_prepare_v2(file->db, "SELECT t FROM event WHERE id = ?", -1, &s, NULL) == SQLITE_OK) {
        sqlite3_bind_int64(s, 1, id);
        if (sqlite3_step(s) == SQLITE_ROW)
            t_us = sqlite3_column_int64(s, 0);
    }
    sqlite3_finalize(s);
    return t_us;
}

/* In the order of an index: a page costs its own rows, wherever it lies. */
#define IN_TIME "SELECT " ROW " FROM event WHERE t BETWEEN ?1 AND ?2 AND (t < ?3 OR id < ?4)"
#define NEWEST " ORDER BY t DESC, id DESC LIMIT ?5"

int journal_file_rows(struct journal_file *file, const struct journal_query *query,
                      void (*each)(void *arg, const struct journal_row *row), void *arg)
{
    sqlite3_stmt *s = NULL;
    int64_t before_us = query->before_id == INT64_MAX ? INT64_MIN : time_of(file, query->before_id), to_us = query->to_us;
    int code = sqlite3_prepare_v2(file->db, query->tag ? IN_TIME " AND tag = ?6" NEWEST : IN_TIME NEWEST, -1, &s, NULL);
    if (before_us != INT64_MIN && before_us < to_us)
        to_us = before_us;
    if (code == SQLITE_OK) {
        sqlite3_bind_int64(s, 1, query->from_us);
        sqlite3_bind_int64(s, 2, to_us);
        sqlite3_bind_int64(s, 3, before_us);
        sqlite3_bind_int64(s, 4, query->before_id);
        sqlite3_bind_int(s, 5, query->limit);
        if (query->tag)
            bind_text(s, 6, query->tag);
        while ((code = sqlite3_step(s)) == SQLITE_ROW)
            tell(s, each, arg);
    }
    sqlite3_finalize(s);
    return fail(file, code, "cannot be read");
}

/* From one alarm to the next in the index, and of each the last row until then: a few steps an alarm, however long the journal is. */
static const char rows_at[] =
    "WITH RECURSIVE known(tag, kind) AS ("
    " SELECT * FROM (SELECT tag, kind FROM event ORDER BY tag, kind LIMIT 1)"
    " UNION ALL SELECT next.tag, next.kind FROM known JOIN event next ON next.id ="
    " coalesce((SELECT id FROM event WHERE tag = known.tag AND kind > known.kind ORDER BY kind LIMIT 1),"
    " (SELECT id FROM event WHERE tag > known.tag ORDER BY tag, kind LIMIT 1))) "
    "SELECT " ROW " FROM event WHERE id IN (SELECT (SELECT id FROM event WHERE tag = known.tag AND kind = known.kind AND t <= ?1"
    " ORDER BY t DESC, id DESC LIMIT 1) FROM known) AND after <> 'normal' ORDER BY id";

int journal_file_at(struct journal_file *file, int64_t t_us, void (*each)(void *arg, const struct journal_row *row), void *arg)
{
    sqlite3_stmt *s = NULL;
    int code = sqlite3_prepare_v2(file->db, rows_at, -1, &s, NULL);
    if (code == SQLITE_OK) {
        sqlite3_bind_int64(s, 1, t_us);
        while ((code = sqlite3_step(s)) == SQLITE_ROW)
            tell(s, each, arg);
    }
    sqlite3_finalize(s);
    return fail(file, code, "cannot be read");
}
