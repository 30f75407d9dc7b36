/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A month's file: making it, opening it, setting it aside where it is damaged. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/damaged.h"
#include "base/mem.h"
#include "base/text.h"
#include "history/month.h"
#include "history/month_file_impl.h"

enum { APPLICATION_ID = 0x50434849 /* "PCHI" */, BUSY_MS = 5000 };

const int64_t history_level_us[LEVEL_COUNT] = { 10 * US_PER_S, 60 * US_PER_S, 600 * US_PER_S, 3600 * US_PER_S };

/* Each version adds one list of statements that leads to it. */
static const char schema_1[] =
    "CREATE TABLE tag(id INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE, unit TEXT NOT NULL, step INTEGER NOT NULL, within REAL NOT NULL);"
    "CREATE TABLE sample(tag INTEGER NOT NULL, t INTEGER NOT NULL, v REAL, q INTEGER NOT NULL, PRIMARY KEY(tag, t)) WITHOUT ROWID;"
    "CREATE TABLE recent(tag INTEGER NOT NULL, t INTEGER NOT NULL, v REAL, q INTEGER NOT NULL);"
    "CREATE TABLE held(tag INTEGER PRIMARY KEY, t INTEGER NOT NULL, v REAL, q INTEGER NOT NULL);"
    "CREATE TABLE rollup(level_s INTEGER NOT NULL, tag INTEGER NOT NULL, t INTEGER NOT NULL, low REAL, high REAL, mean REAL,"
    " first REAL, last REAL,"
    " good_us INTEGER NOT NULL, bad_us INTEGER NOT NULL, q INTEGER NOT NULL, PRIMARY KEY(level_s, tag, t)) WITHOUT ROWID;"
    "CREATE TABLE event(t INTEGER NOT NULL, kind TEXT NOT NULL, text TEXT NOT NULL);"
    "CREATE VIEW history AS SELECT name AS tag, strftime('%Y-%m-%dT%H:%M:%fZ', s.t / 1e6, 'unixepoch') AS utc, s.v AS value, unit,"
    " printf('0x%08X', s.q) AS quality FROM (SELECT * FROM sample UNION ALL SELECT * FROM recent UNION ALL SELECT * FROM held) s"
    " JOIN tag ON tag.id = s.tag;";
/* What is held may be kept already: it is told once. */
static const char schema_2[] =
    "DROP VIEW history;"
    "CREATE VIEW history AS SELECT name AS tag, strftime('%Y-%m-%dT%H:%M:%fZ', s.t / 1e6, 'unixepoch') AS utc, s.v AS value, unit,"
    " printf('0x%08X', s.q) AS quality FROM (SELECT * FROM sample UNION ALL SELECT * FROM recent UNION ALL SELECT * FROM held h"
    " WHERE NOT EXISTS (SELECT 1 FROM sample WHERE tag = h.tag AND t = h.t)"
    " AND NOT EXISTS (SELECT 1 FROM recent WHERE tag = h.tag AND t = h.t)) s JOIN tag ON tag.id = s.tag;";
static const char *const schemas[HISTORY_VERSION] = { schema_1, schema_2 };

static const char *const sql[SQL_COUNT] = {
    [SQL_BEGIN] = "BEGIN IMMEDIATE",
    [SQL_BEGIN_READ] = "BEGIN",
    [SQL_COMMIT] = "COMMIT",
    [SQL_ROLLBACK] = "ROLLBACK",
    [SQL_FIND_TAG] = "SELECT id, step, unit FROM tag WHERE name = ?",
    [SQL_ADD_TAG] = "INSERT INTO tag(name, unit, step, within) VALUES(?, ?, ?, ?) ON CONFLICT(name) DO UPDATE"
                    " SET unit = excluded.unit, step = excluded.step, within = excluded.within RETURNING id",
    [SQL_ADD_RECENT] = "INSERT INTO recent(tag, t, v, q) VALUES(?, ?, ?, ?)",
    [SQL_HOLD] = "INSERT OR REPLACE INTO held(tag, t, v, q) VALUES(?, ?, ?, ?)",
    [SQL_ADD_SAMPLE] = "INSERT OR REPLACE INTO sample(tag, t, v, q) VALUES(?, ?, ?, ?)",
    [SQL_ADD_ROLLUP] = "INSERT OR REPLACE INTO rollup(level_s, tag, t, low, high, mean, first, last, good_us, bad_us, q)"
                       " VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
    [SQL_RECENT] = "SELECT tag, t, v, q FROM recent ORDER BY tag, t",
    [SQL_CLEAR_RECENT] = "DELETE FROM recent",
    [SQL_LAST_SAMPLE] = "SELECT t FROM sample WHERE tag = ? ORDER BY t DESC LIMIT 1",
    [SQL_SAMPLES_FROM] = "SELECT t, v, q FROM sample WHERE tag = ?1"
                         " AND t >= coalesce((SELECT max(t) FROM sample WHERE tag = ?1 AND t < ?2), ?2) ORDER BY t",
    [SQL_ALL_HELD] = "SELECT tag, t, v, q FROM held",
    [SQL_CLEAR_HELD] = "DELETE FROM held",
    [SQL_CLEAR_ROLLUPS] = "DELETE FROM rollup WHERE level_s = ? AND tag = ? AND t >= ? AND t < ?",
    [SQL_EVENTS] = "SELECT t, kind, text FROM event WHERE kind IN ('gap', 'clock')",
    [SQL_NOTE] = "INSERT INTO event(t, kind, text) VALUES(?, ?, ?)",
    [SQL_BEFORE] = "SELECT t, v, q FROM sample WHERE tag = ? AND t <= ? ORDER BY t DESC LIMIT 1",
    [SQL_AFTER] = "SELECT t, v, q FROM sample WHERE tag = ? AND t > ? ORDER BY t LIMIT 1",
    [SQL_RANGE] = "SELECT t, v, q FROM sample WHERE tag = ?1 AND t BETWEEN ?2 AND ?3 ORDER BY t",
    [SQL_RECENT_OF] = "SELECT t, v, q FROM recent WHERE tag = ?",
    [SQL_HELD_OF] = "SELECT t, v, q FROM held WHERE tag = ?",
    [SQL_ROLLUPS] = "SELECT t, low, high, mean, first, last, good_us, bad_us, q FROM rollup"
                    " WHERE level_s = ? AND tag = ? AND t > ? AND t <= ? ORDER BY t",
    [SQL_RECENT_ALL] = "SELECT tag, t, v, q FROM recent UNION ALL SELECT tag, t, v, q FROM held",
    [SQL_WAITING] = "SELECT count(*) FROM recent",
    [SQL_SPAN] = "SELECT min(a), max(b) FROM (SELECT min(t) AS a, max(t) AS b FROM recent UNION ALL SELECT min(t), max(t) FROM held"
                 " UNION ALL SELECT (SELECT min(t) FROM sample WHERE tag = id), (SELECT max(t) FROM sample WHERE tag = id) FROM tag)",
};

/* --- for the other files ------------------------------------------------------------------------------------------------------ */

sqlite3_stmt *month_sql(struct month_file *file, enum month_statement which)
{
    sqlite3_stmt **statement = &file->statements[which];
    if (!*statement && sqlite3_prepare_v3(file->db, sql[which], -1, SQLITE_PREPARE_PERSISTENT, statement, NULL) != SQLITE_OK)
        return NULL;
    sqlite3_reset(*statement);
    return *statement;
}

int month_run(sqlite3_stmt *statement)
{
    int code;
    if (!statement)
        return SQLITE_ERROR;
    do
        code = sqlite3_step(statement);
    while (code == SQLITE_ROW);
    sqlite3_reset(statement);
    return code == SQLITE_DONE ? SQLITE_OK : code;
}

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
    case SQLITE_NOMEM: return ENOMEM;
    default: return EIO;
    }
}

static bool is_on_read_only_disk(const struct month_file *file)
{
    return access(file->path, W_OK) != 0 && errno == EROFS;
}

/* What the system said, where SQLite only says that it cannot. */
static int cause_of(const struct month_file *file)
{
    return is_on_read_only_disk(file) ? EROFS : sqlite3_system_errno(file->db);
}

int month_fail(struct month_file *file, int code, const char *doing)
{
    if (code == SQLITE_OK || code == SQLITE_ROW || code == SQLITE_DONE)
        return 0;
    bool told = file->db && sqlite3_errcode(file->db) != SQLITE_OK;
    int error = errno_of(code), cause = (error == EACCES || error == EIO) && told ? cause_of(file) : 0;
    log_err(file->log, "%s: %s: %s%s%s", file->path, doing, told ? sqlite3_errmsg(file->db) : sqlite3_errstr(code), cause ? ": " : "",
            cause ? strerror(cause) : "");
    return -(cause ? cause : error);
}

void month_bind_value(sqlite3_stmt *statement, int index, double value)
{
    if (isnan(value))
        sqlite3_bind_null(statement, index);
    else
        sqlite3_bind_double(statement, index, value);
}

double month_value(sqlite3_stmt *statement, int column)
{
    return sqlite3_column_type(statement, column) == SQLITE_NULL ? NAN : sqlite3_column_double(statement, column);
}

struct history_point month_point(sqlite3_stmt *statement, int first_column)
{
    return (struct history_point){
        .t_us = sqlite3_column_int64(statement, first_column),
        .value = month_value(statement, first_column + 1),
        .quality = (uint32_t)sqlite3_column_int64(statement, first_column + 2),
    };
}

void history_points_add(struct history_points *points, const struct history_point *point)
{
    mem_grow(&points->at, &points->capacity, points->count + 1, sizeof(*points->at));
    points->at[points->count++] = *point;
}

/* --- opening ------------------------------------------------------------------------------------------------------------------ */

static int pragma_int(sqlite3 *db, const char *pragma, int *code)
{
    sqlite3_stmt *statement = NULL;
    int value = 0;
    if ((*code = sqlite3_prepare_v2(db, pragma, -1, &statement, NULL)) != SQLITE_OK)
        return 0;
    *code = sqlite3_step(statement);
    if (*code == SQLITE_ROW) {
        value = sqlite3_column_int(statement, 0);
        *code = SQLITE_OK;
    }
    sqlite3_finalize(statement);
    return value;
}

/* From whatever version the file has to this program's, or none of it. */
static int migrate(struct month_file *file)
{
    int code, version = pragma_int(file->db, "PRAGMA user_version", &code);
    if (code != SQLITE_OK || version == HISTORY_VERSION)
        return code;
    if (version > HISTORY_VERSION) {
        log_err(file->log, "%s: version %d is a newer Plantcast's; this program knows version %d", file->path, version, HISTORY_VERSION);
        return SQLITE_PERM;
    }
    if ((code = sqlite3_exec(file->db, "BEGIN IMMEDIATE", NULL, NULL, NULL)) != SQLITE_OK)
        return code;
    for (; code == SQLITE_OK && version < HISTORY_VERSION; version++)
        code = sqlite3_exec(file->db, schemas[version], NULL, NULL, NULL);
    char *stamp = mem_printf("PRAGMA user_version = %d; PRAGMA application_id = %d;", HISTORY_VERSION, APPLICATION_ID);
    if (code == SQLITE_OK)
        code = sqlite3_exec(file->db, stamp, NULL, NULL, NULL);
    mem_free(stamp);
    int ended = sqlite3_exec(file->db, code == SQLITE_OK ? "COMMIT" : "ROLLBACK", NULL, NULL, NULL);
    return code == SQLITE_OK ? ended : code;
}

static int open_database(struct month_file *file, int flags)
{
    int code = sqlite3_open_v2(file->path, &file->db, flags | SQLITE_OPEN_NOMUTEX, NULL);
    if (code != SQLITE_OK)
        return code;
    sqlite3_extended_result_codes(file->db, 1);
    sqlite3_busy_timeout(file->db, BUSY_MS);
    return code;
}

/* On a disk that cannot be written SQLite makes no files beside it; where there are none, nothing is missing. */
static int open_unchanging(struct month_file *file)
{
    struct text uri = { 0 };
    text_add(&uri, "file:");
    for (const char *c = file->path; *c; c++)
        text_add(&uri, strchr("%?#", *c) ? "%%%02X" : "%c", (unsigned char)*c);
    text_add(&uri, "?immutable=1");
    sqlite3_close(file->db);
    int code = sqlite3_open_v2(uri.at, &file->db, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX, NULL);
    text_finish(&uri);
    return code;
}

static bool has_log(const struct month_file *file)
{
    char *path = mem_printf("%s-wal", file->path);
    bool there = access(path, F_OK) == 0;
    mem_free(path);
    return there;
}

static int open_to_read(struct month_file *file, int *version)
{
    int code = open_database(file, SQLITE_OPEN_READONLY);
    if (code == SQLITE_OK)
        *version = pragma_int(file->db, "PRAGMA user_version", &code);
    if ((code & 0xff) != SQLITE_CANTOPEN || has_log(file) || !is_on_read_only_disk(file))
        return code; /* elsewhere somebody may be about to write it */
    code = open_unchanging(file);
    if (code == SQLITE_OK)
        *version = pragma_int(file->db, "PRAGMA user_version", &code);
    return code;
}

static int open_to_write(struct month_file *file)
{
    /* FULL: what was committed outlives a loss of power too. One commit a second makes it cheap. */
    static const char set_up[] = "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA cache_size = -16000; "
                                 "PRAGMA wal_autocheckpoint = 4000;";
    int code = open_database(file, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
    if (code == SQLITE_OK)
        code = sqlite3_exec(file->db, set_up, NULL, NULL, NULL);
    if (code == SQLITE_OK)
        code = migrate(file);
    if (code != SQLITE_OK)
        return code;
    sqlite3_stmt *waiting = month_sql(file, SQL_WAITING);
    code = waiting ? sqlite3_step(waiting) : SQLITE_ERROR;
    if (code == SQLITE_ROW)
        file->waiting = (size_t)sqlite3_column_int64(waiting, 0);
    sqlite3_reset(waiting);
    return code == SQLITE_ROW ? SQLITE_OK : waiting ? code : sqlite3_errcode(file->db);
}

static void close_database(struct month_file *file)
{
    for (int i = 0; i < SQL_COUNT; i++) {
        sqlite3_finalize(file->statements[i]);
        file->statements[i] = NULL;
    }
    sqlite3_close(file->db);
    file->db = NULL;
}

static bool set_aside(struct month_file *file)
{
    close_database(file);
    return damaged_set_aside(file->log, file->path);
}

static ino_t inode_of(const char *path)
{
    struct stat st;
    return stat(path, &st) == 0 ? st.st_ino : 0;
}

static struct month_file *create(struct log *log, const char *folder, int month)
{
    struct month_file *file = mem_new(sizeof(*file));
    char name[MONTH_NAME_BYTES];
    month_name(month, name);
    file->log = log;
    file->month = month;
    file->path = mem_printf("%s/%s", folder, name);
    return file;
}

struct month_file *month_file_open(struct log *log, const char *folder, int month, const struct history_tag *tags, size_t tag_count,
                                   int *error)
{
    struct month_file *file = create(log, folder, month);
    file->tags = tags;
    file->tag_count = tag_count;
    int code = open_to_write(file);
    if (errno_of(code) == EBADMSG && code != SQLITE_OK && set_aside(file))
        code = open_to_write(file);
    *error = month_fail(file, code, "cannot be opened");
    if (*error)
        goto error;
    file->inode = inode_of(file->path);
    file->ids = mem_array(tag_count, sizeof(*file->ids));
    file->rollups = mem_array(tag_count, sizeof(*file->rollups));
    return file;
error:
    month_file_close(&file);
    return NULL;
}

struct month_file *month_file_read(struct log *log, const char *folder, int month, int *error)
{
    struct month_file *file = create(log, folder, month);
    if (access(file->path, F_OK) != 0) {
        *error = -errno;
        goto error;
    }
    int version = 0, code = open_to_read(file, &version);
    *error = month_fail(file, code, "cannot be read");
    if (!*error && (version < 1 || version > HISTORY_VERSION)) {
        log_err(log, "%s: is of version %d; this program reads 1 to %d", file->path, version, HISTORY_VERSION);
        *error = -EPROTO;
    }
    if (*error)
        goto error;
    file->inode = inode_of(file->path);
    return file;
error:
    month_file_close(&file);
    return NULL;
}

bool month_file_is_there(const struct month_file *file)
{
    return inode_of(file->path) == file->inode;
}

void month_file_close(struct month_file **file)
{
    if (!*file)
        return;
    close_database(*file);
    mem_free((*file)->ids);
    mem_free((*file)->rollups);
    mem_free((*file)->path);
    mem_free(*file);
    *file = NULL;
}

void month_file_set_aside(struct month_file **file)
{
    set_aside(*file);
    month_file_close(file);
}

int month_file_month(const struct month_file *file)
{
    return file->month;
}

size_t month_file_waiting(const struct month_file *file)
{
    return file->waiting;
}
