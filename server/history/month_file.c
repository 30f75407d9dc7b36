/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Opens a month's history file: its tables, their migrations from older versions, and the SQL statements. */
#include <stdio.h>
#include <sys/stat.h>

#include "base/mem.h"
#include "history/month.h"
#include "history/month_blocks.h"
#include "history/month_seconds.h"

enum { APPLICATION_ID = 0x50434849 /* the letters PCHI, by which SQLite's tools recognise the file */ };

const int64_t history_level_us[LEVEL_COUNT] = { 60 * US_PER_S, 600 * US_PER_S, 3600 * US_PER_S };

/* Migrations: schemas[n - 1] is the SQL that upgrades a history file from version n - 1 to version n. */
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
/* From version 2 on, the view omits held samples (newest samples, stored in case of a crash) that are also recorded, so that
   each point appears once. */
static const char schema_2[] =
    "DROP VIEW history;"
    "CREATE VIEW history AS SELECT name AS tag, strftime('%Y-%m-%dT%H:%M:%fZ', s.t / 1e6, 'unixepoch') AS utc, s.v AS value, unit,"
    " printf('0x%08X', s.q) AS quality FROM (SELECT * FROM sample UNION ALL SELECT * FROM recent UNION ALL SELECT * FROM held h"
    " WHERE NOT EXISTS (SELECT 1 FROM sample WHERE tag = h.tag AND t = h.t)"
    " AND NOT EXISTS (SELECT 1 FROM recent WHERE tag = h.tag AND t = h.t)) s JOIN tag ON tag.id = s.tag;";
/* From version 3 on, points are in compressed blocks, which SQL cannot read, so there is no view. Points from older versions
   stay in the table `sample`. */
static const char schema_3[] =
    "DROP VIEW history;"
    "INSERT OR REPLACE INTO sample SELECT tag, t, v, q FROM recent;"
    "DELETE FROM recent;"
    "CREATE TABLE chunk(id INTEGER PRIMARY KEY AUTOINCREMENT, last INTEGER NOT NULL, times BLOB NOT NULL);"
    "CREATE TABLE block(tag INTEGER NOT NULL, t INTEGER NOT NULL, last INTEGER NOT NULL, chunk INTEGER NOT NULL, data BLOB NOT NULL,"
    " PRIMARY KEY(tag, t)) WITHOUT ROWID;"
    "CREATE TABLE second(n INTEGER PRIMARY KEY, stamp INTEGER NOT NULL, data BLOB NOT NULL);"
    /* stamps (numbers that increase with each write) start at 1 << 40, so that SQLite stores every stamp in 6 bytes; rows of
       the table `second` thus keep their size and are overwritten in place */
    "INSERT INTO second VALUES(0, 1099511627776, x'');";
static const char *const schemas[HISTORY_VERSION] = { schema_1, schema_2, schema_3 };

static const char *const sql[SQL_COUNT] = {
    [SQL_BEGIN] = "BEGIN IMMEDIATE",
    [SQL_BEGIN_READ] = "BEGIN",
    [SQL_COMMIT] = "COMMIT",
    [SQL_ROLLBACK] = "ROLLBACK",
    /* also finds earlier series of the tag that were set aside, because their unit cannot be converted to the unit that the tag
       has now. They are named after the tag, followed by char(31) and their id */
    [SQL_FIND_TAG] = "SELECT id, step, unit FROM tag WHERE name = ?1 OR (name > ?1 || char(31) AND name < ?1 || char(32)) ORDER BY name",
    [SQL_RENAME_TAG] = "UPDATE tag SET name = ?2 WHERE id = ?1",
    [SQL_TAG_UNIT] = "SELECT unit FROM tag WHERE id = ?",
    [SQL_ADD_TAG] = "INSERT INTO tag(name, unit, step, within) VALUES(?, ?, ?, ?) ON CONFLICT(name) DO UPDATE"
                    " SET unit = excluded.unit, step = excluded.step, within = excluded.within RETURNING id",
    [SQL_SET_STEP] = "UPDATE tag SET step = ?2, within = ?3 WHERE id = ?1",
    [SQL_HOLD] = "INSERT OR REPLACE INTO held(tag, t, v, q) VALUES(?, ?, ?, ?)",
    [SQL_ADD_ROLLUP] = "INSERT OR REPLACE INTO rollup(level_s, tag, t, low, high, mean, first, last, good_us, bad_us, q)"
                       " VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
    [SQL_ALL_HELD] = "SELECT tag, t, v, q FROM held",
    [SQL_FORGET_GAPS] = "DELETE FROM sample WHERE t BETWEEN ? AND ? AND q = ?",
    [SQL_FORGET_GAP_NOTES] = "DELETE FROM event WHERE t BETWEEN ? AND ? AND kind = 'gap'",
    [SQL_FORGET_OUTBOX_GAPS] = "DELETE FROM outbox WHERE t BETWEEN ? AND ? AND q = ?",
    [SQL_CLEAR_HELD] = "DELETE FROM held",
    [SQL_CLEAR_ROLLUPS] = "DELETE FROM rollup WHERE level_s = ? AND tag = ? AND t >= ? AND t < ?",
    [SQL_EVENTS] = "SELECT t, kind, text FROM event WHERE kind IN ('gap', 'clock')",
    [SQL_NOTE] = "INSERT INTO event(t, kind, text) VALUES(?, ?, ?)",
    [SQL_BEFORE] = "SELECT t, v, q FROM sample WHERE tag = ? AND t <= ? ORDER BY t DESC LIMIT 1",
    [SQL_AFTER] = "SELECT t, v, q FROM sample WHERE tag = ? AND t > ? ORDER BY t LIMIT 1",
    [SQL_RANGE] = "SELECT t, v, q FROM sample WHERE tag = ?1 AND t BETWEEN ?2 AND ?3 ORDER BY t LIMIT ?4",
    [SQL_RECENT_OF] = "SELECT t, v, q FROM recent WHERE tag = ?",
    [SQL_HELD_OF] = "SELECT t, v, q FROM held WHERE tag = ?",
    [SQL_ROLLUPS] = "SELECT t, low, high, mean, first, last, good_us, bad_us, q FROM rollup"
                    " WHERE level_s = ?1 AND tag = ?2 AND t <= ?4 AND t >= coalesce((SELECT max(t) FROM rollup"
                    " WHERE level_s = ?1 AND tag = ?2 AND t <= ?3), ?3) ORDER BY t",
    [SQL_NEWEST_ROLLUP] = "SELECT max(t) FROM rollup WHERE level_s = ? AND tag = ?",
    [SQL_RECENT_ALL] = "SELECT tag, t, v, q FROM recent",
    [SQL_ALL_TAGS] = "SELECT id FROM tag",
    [SQL_CUT_SAMPLES] = "DELETE FROM sample WHERE tag = ? AND t < ?",
    [SQL_CUT_ROLLUPS] = "DELETE FROM rollup WHERE level_s = ?2 AND tag = ?1 AND t < ?3",
    [SQL_CUT_EVENTS] = "DELETE FROM event WHERE t < ?",
    [SQL_SIZE] = "SELECT page_size, page_count, freelist_count, auto_vacuum FROM pragma_page_size, pragma_page_count,"
                 " pragma_freelist_count, pragma_auto_vacuum",
    [SQL_SHRINK] = "PRAGMA incremental_vacuum",
    [SQL_WAITING] = "SELECT count(*), max(stamp) FROM second WHERE n > 0 AND stamp > (SELECT stamp FROM second WHERE n = 0)",
    [SQL_HAS_BLOCKS] = "SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = 'block'",
    [SQL_BLOCKS] = "SELECT chunk, data FROM block WHERE tag = ?1"
                   " AND t >= coalesce((SELECT max(t) FROM block WHERE tag = ?1 AND t <= ?2), ?2) ORDER BY t",
    [SQL_NEXT_BLOCK] = "SELECT chunk, data, t FROM block WHERE tag = ?1 AND t > ?2 AND t <= ?3 AND last >= ?4"
                       " AND t >= coalesce((SELECT max(t) FROM block WHERE tag = ?1 AND t <= ?4), ?4) ORDER BY t LIMIT 1",
    [SQL_ADD_BLOCK] = "INSERT INTO block(tag, t, last, chunk, data) VALUES(?, ?, ?, ?, ?)",
    [SQL_DELETE_BLOCK] = "DELETE FROM block WHERE tag = ? AND t = ?",
    [SQL_BLOCK_SPAN] = "SELECT min(a), max(b) FROM (SELECT (SELECT t FROM block WHERE tag = id ORDER BY t LIMIT 1) AS a,"
                       " (SELECT last FROM block WHERE tag = id ORDER BY t DESC LIMIT 1) AS b FROM tag)",
    [SQL_CUT_BLOCKS] = "DELETE FROM block WHERE tag = ?1 AND t < ?2 AND last < ?2",
    [SQL_CHUNK] = "SELECT times FROM chunk WHERE id = ?",
    [SQL_ADD_CHUNK] = "INSERT INTO chunk(last, times) VALUES(?, ?)",
    [SQL_CUT_CHUNKS] = "DELETE FROM chunk WHERE last < ?",
    [SQL_MARK] = "SELECT stamp FROM second WHERE n = 0",
    [SQL_SET_MARK] = "UPDATE second SET stamp = ? WHERE n = 0",
    [SQL_SECONDS] = "SELECT n, stamp, data FROM second WHERE n > ? ORDER BY n",
    [SQL_ADD_SECOND] = "INSERT INTO second(n, stamp, data) VALUES(?1, ?2, ?3)",
    [SQL_UPDATE_SECOND] = "UPDATE second SET stamp = ?2, data = ?3 WHERE n = ?1",
    [SQL_ADD_OUTBOX] = "INSERT INTO outbox(tag, t, v, q) VALUES(?, ?, ?, ?)",
    [SQL_HAS_OUTBOX] = "SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = 'outbox'",
    /* deletes points from the table `outbox` (points to be sent to PostgreSQL) in order of insertion, up to the first one that
       is recent enough to stay: the table has no index on time */
    [SQL_CUT_OUTBOX] = "DELETE FROM outbox WHERE seq < coalesce((SELECT seq FROM outbox WHERE t >= ?1 ORDER BY seq LIMIT 1),"
                       " (SELECT max(seq) + 1 FROM outbox))",
    [SQL_SPAN] = "SELECT min(a), max(b) FROM (SELECT min(t) AS a, max(t) AS b FROM recent UNION ALL SELECT min(t), max(t) FROM held"
                 " UNION ALL SELECT (SELECT min(t) FROM sample WHERE tag = id), (SELECT max(t) FROM sample WHERE tag = id) FROM tag)",
};

static const struct database_format format = {
    APPLICATION_ID,
    HISTORY_VERSION,
    /* page_size: pages of 1024 bytes are smaller than SQLite's default, because SQLite writes whole pages, but each second
       changes only a few bytes of the table `second` */
    "PRAGMA page_size = 1024; PRAGMA auto_vacuum = INCREMENTAL; PRAGMA cache_size = -16000; PRAGMA wal_autocheckpoint = 32000",
    schemas,
    sql,
    SQL_COUNT,
};

/* --- shared with month_file_*.c ----------------------------------------------------------------------------------------------- */

sqlite3_stmt *month_sql(struct month_file *file, enum month_statement which)
{
    return database_statement(&file->db, (int)which);
}

int month_has_outbox(struct month_file *file, bool *has)
{
    sqlite3_stmt *find = month_sql(file, SQL_HAS_OUTBOX);
    int code = database_step(&file->db, find);
    sqlite3_reset(find);
    *has = code == SQLITE_ROW;
    return code == SQLITE_DONE ? 0 : database_fail(&file->db, code, "cannot be read");
}

bool month_has_blocks(struct month_file *file)
{
    if (!file->has_blocks) {
        sqlite3_stmt *find = month_sql(file, SQL_HAS_BLOCKS);
        file->has_blocks = database_step(&file->db, find) == SQLITE_ROW;
        sqlite3_reset(find);
    }
    return file->has_blocks;
}

int month_run(struct month_file *file, sqlite3_stmt *statement, const char *doing)
{
    return database_fail(&file->db, database_run(&file->db, statement), doing);
}

struct history_point month_point(sqlite3_stmt *statement, int first_column)
{
    return (struct history_point){
        .t_us = sqlite3_column_int64(statement, first_column),
        .value = database_value(statement, first_column + 1),
        .quality = (uint32_t)sqlite3_column_int64(statement, first_column + 2),
    };
}

void history_points_add(struct history_points *points, const struct history_point *point)
{
    mem_grow(&points->at, &points->capacity, points->count + 1, sizeof(*points->at));
    points->at[points->count++] = *point;
}

/* --- opening ------------------------------------------------------------------------------------------------------------------ */

static int count_waiting(struct month_file *file)
{
    sqlite3_stmt *waiting = month_sql(file, SQL_WAITING);
    int code = database_step(&file->db, waiting);
    if (code == SQLITE_ROW) {
        file->waiting = (size_t)sqlite3_column_int64(waiting, 0);
        file->slot = sqlite3_column_int64(waiting, 0);
        file->stamp = sqlite3_column_int64(waiting, 1);
    }
    sqlite3_reset(waiting);
    return code;
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
    file->month = month;
    file->chunk = mem_new(sizeof(*file->chunk));
    file->seconds = mem_new(sizeof(*file->seconds));
    database_init(&file->db, log, mem_printf("%s/%s", folder, name), &format);
    return file;
}

struct month_file *month_file_open(struct log *log, const char *folder, int month, const struct history_tag *tags, size_t tag_count,
                                   int *error)
{
    struct month_file *file = create(log, folder, month);
    bool renewed;
    file->tags = tags;
    file->tag_count = tag_count;
    *error = database_open(&file->db, &renewed);
    int code = *error ? SQLITE_OK : count_waiting(file);
    if ((code & 0xff) == SQLITE_CORRUPT && database_set_aside(&file->db) && !(*error = database_open(&file->db, &renewed)))
        code = count_waiting(file);
    if (!*error)
        *error = database_fail(&file->db, code, "cannot be opened");
    if (*error)
        goto error;
    file->inode = inode_of(file->db.path);
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
    *error = database_open_to_read(&file->db);
    if (*error)
        month_file_close(&file);
    else
        file->inode = inode_of(file->db.path);
    return file;
}

bool month_file_is_there(const struct month_file *file)
{
    return inode_of(file->db.path) == file->inode;
}

void month_file_close(struct month_file **file)
{
    if (!*file)
        return;
    database_finish(&(*file)->db);
    month_seconds_finish(*file);
    mem_free((*file)->seconds);
    mem_free((*file)->chunk->times);
    mem_free((*file)->chunk);
    mem_free((*file)->ids);
    mem_free((*file)->rollups);
    mem_free(*file);
    *file = NULL;
}

void month_file_set_aside(struct month_file **file)
{
    database_set_aside(&(*file)->db);
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
