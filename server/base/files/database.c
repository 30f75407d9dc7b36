/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Opens SQLite files, upgrades files that an earlier version of the program wrote, and converts SQLite's errors to -errno. */
#include "base/files/database.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/mem.h"
#include "base/text/text.h"

enum { BUSY_MS = 5000 };

void database_init(struct database *database, struct log *log, char *path, const struct database_format *format)
{
    *database = (struct database){ .log = log, .format = format, .path = path };
    database->statements = mem_array(format->statement_count, sizeof(*database->statements));
}

static void close_handle(struct database *database)
{
    for (size_t i = 0; database->handle && i < database->format->statement_count; i++) {
        sqlite3_finalize(database->statements[i]);
        database->statements[i] = NULL;
    }
    sqlite3_close(database->handle);
    database->handle = NULL;
}

void database_finish(struct database *database)
{
    close_handle(database);
    mem_free(database->statements);
    mem_free(database->path);
    *database = (struct database){ 0 };
}

/* --- errors ------------------------------------------------------------------------------------------------------------------- */

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

static bool is_on_read_only_disk(const struct database *database)
{
    return access(database->path, W_OK) != 0 && errno == EROFS;
}

/* Returns the errno behind a generic SQLite error such as "unable to open". */
static int cause_of(const struct database *database)
{
    return is_on_read_only_disk(database) ? EROFS : sqlite3_system_errno(database->handle);
}

int database_fail(struct database *database, int code, const char *doing)
{
    if (code == SQLITE_OK || code == SQLITE_ROW || code == SQLITE_DONE)
        return 0;
    bool told = database->handle && sqlite3_errcode(database->handle) != SQLITE_OK;
    int error = errno_of(code), cause = (error == EACCES || error == EIO) && told ? cause_of(database) : 0;
    log_lasting_err(database->log, "%s: %s: %s%s%s", database->path, doing, told ? sqlite3_errmsg(database->handle) : sqlite3_errstr(code),
                    cause ? ": " : "", cause ? strerror(cause) : "");
    return -(cause ? cause : error);
}

/* --- statements --------------------------------------------------------------------------------------------------------------- */

sqlite3_stmt *database_statement(struct database *database, int index)
{
    sqlite3_stmt **statement = &database->statements[index];
    const char *sql = database->format->statements[index];
    if (!*statement && sqlite3_prepare_v3(database->handle, sql, -1, SQLITE_PREPARE_PERSISTENT, statement, NULL) != SQLITE_OK)
        return NULL;
    sqlite3_reset(*statement);
    return *statement;
}

int database_step(struct database *database, sqlite3_stmt *statement)
{
    int code = statement ? sqlite3_step(statement) : sqlite3_errcode(database->handle);
    return statement || code != SQLITE_OK ? code : SQLITE_ERROR;
}

int database_run(struct database *database, sqlite3_stmt *statement)
{
    int code;
    do
        code = database_step(database, statement);
    while (code == SQLITE_ROW && statement);
    sqlite3_reset(statement);
    return code == SQLITE_DONE ? SQLITE_OK : code;
}

int database_exec(struct database *database, const char *sql, const char *doing)
{
    return database_fail(database, sqlite3_exec(database->handle, sql, NULL, NULL, NULL), doing);
}

void database_bind_text(sqlite3_stmt *statement, int index, const char *text)
{
    sqlite3_bind_text(statement, index, text, -1, SQLITE_STATIC);
}

void database_bind_value(sqlite3_stmt *statement, int index, double value)
{
    if (isnan(value))
        sqlite3_bind_null(statement, index);
    else
        sqlite3_bind_double(statement, index, value);
}

double database_value(sqlite3_stmt *statement, int column)
{
    return sqlite3_column_type(statement, column) == SQLITE_NULL ? NAN : sqlite3_column_double(statement, column);
}

const char *database_text(sqlite3_stmt *statement, int column)
{
    const char *text = (const char *)sqlite3_column_text(statement, column);
    return text ? text : "";
}

/* --- opening ------------------------------------------------------------------------------------------------------------------ */

static int read_version(struct database *database, int *version)
{
    sqlite3_stmt *statement = NULL;
    int code = sqlite3_prepare_v2(database->handle, "PRAGMA user_version", -1, &statement, NULL);
    if (code == SQLITE_OK && (code = sqlite3_step(statement)) == SQLITE_ROW)
        *version = sqlite3_column_int(statement, 0);
    sqlite3_finalize(statement);
    return code == SQLITE_ROW ? SQLITE_OK : code;
}

static bool is_newer(struct database *database, int version)
{
    int known = database->format->version;
    if (version > known)
        log_lasting_err(
            database->log,
            "%s: version %d of this file was written by a newer Plantcast; this program supports version %d, and neither reads nor "
            "changes the file. Install the newer Plantcast again; or stop the daemon, run `mv %s* ANOTHER_FOLDER`, and start the daemon",
            database->path, version, known, database->path);
    return version > known;
}

static int migrate(struct database *database, int version)
{
    const struct database_format *format = database->format;
    int code = sqlite3_exec(database->handle, "BEGIN IMMEDIATE", NULL, NULL, NULL);
    if (code != SQLITE_OK)
        return code;
    for (; code == SQLITE_OK && version < format->version; version++)
        code = sqlite3_exec(database->handle, format->schemas[version], NULL, NULL, NULL);
    char *stamp = mem_printf("PRAGMA user_version = %d; PRAGMA application_id = %d;", format->version, format->application_id);
    if (code == SQLITE_OK)
        code = sqlite3_exec(database->handle, stamp, NULL, NULL, NULL);
    mem_free(stamp);
    int ended = sqlite3_exec(database->handle, code == SQLITE_OK ? "COMMIT" : "ROLLBACK", NULL, NULL, NULL);
    return code == SQLITE_OK ? ended : code;
}

static int open_handle(struct database *database, const char *name, int flags)
{
    int code = sqlite3_open_v2(name, &database->handle, flags | SQLITE_OPEN_NOMUTEX, NULL);
    if (code == SQLITE_OK) {
        sqlite3_extended_result_codes(database->handle, 1);
        sqlite3_busy_timeout(database->handle, BUSY_MS);
    }
    return code;
}

static int open_to_write(struct database *database, int *version)
{
    /* synchronous = FULL: committed transactions survive a power failure */
    static const char set_up[] = "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL";
    int code = open_handle(database, database->path, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
    if (code == SQLITE_OK)
        code = read_version(database, version);
    if (code == SQLITE_OK && *version > database->format->version)
        return SQLITE_OK;  /* the file of a newer version is not changed, not even by the pragmas below */
    if (code == SQLITE_OK) /* the format's pragmas must run first: some have an effect only on a file without pages */
        code = sqlite3_exec(database->handle, database->format->set_up, NULL, NULL, NULL);
    if (code == SQLITE_OK)
        code = sqlite3_exec(database->handle, set_up, NULL, NULL, NULL);
    return code == SQLITE_OK && *version < database->format->version ? migrate(database, *version) : code;
}

const char *database_error_text(int error)
{
    return error == -DATABASE_NEWER ? "a newer Plantcast wrote a file: an earlier line names the file and what to do" : strerror(-error);
}

int database_open(struct database *database, bool *renewed)
{
    int version = 0, code = open_to_write(database, &version);
    *renewed = code != SQLITE_OK && errno_of(code) == EBADMSG && database_set_aside(database);
    if (*renewed)
        code = open_to_write(database, &version);
    int error = database_fail(database, code, "cannot be opened");
    return error || !is_newer(database, version) ? error : -DATABASE_NEWER;
}

/* Opens a database on a read-only disk as immutable, because SQLite cannot create its -wal and -shm files there. Correct only
   if no -wal file exists: its rows would be ignored. */
static int open_unchanging(struct database *database)
{
    struct text uri = { 0 };
    text_add(&uri, "file:");
    for (const char *c = database->path; *c; c++)
        text_add(&uri, strchr("%?#", *c) ? "%%%02X" : "%c", (unsigned char)*c);
    text_add(&uri, "?immutable=1");
    sqlite3_close(database->handle);
    int code = open_handle(database, uri.at, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI);
    text_finish(&uri);
    return code;
}

static bool has_log(const struct database *database)
{
    char *path = mem_printf("%s-wal", database->path);
    bool there = access(path, F_OK) == 0;
    mem_free(path);
    return there;
}

int database_open_to_read(struct database *database)
{
    int version = 0;
    if (access(database->path, F_OK) != 0)
        return -errno;
    int code = open_handle(database, database->path, SQLITE_OPEN_READONLY);
    if (code == SQLITE_OK)
        code = read_version(database, &version);
    /* opens as immutable only on a read-only disk: on a writable one, another process may change the file in the meantime */
    if ((code & 0xff) == SQLITE_CANTOPEN && !has_log(database) && is_on_read_only_disk(database)) {
        code = open_unchanging(database);
        if (code == SQLITE_OK)
            code = read_version(database, &version);
    }
    int error = database_fail(database, code, "cannot be read");
    return error ? error : is_newer(database, version) ? -DATABASE_NEWER : version ? 0 : -ENOENT;
}

int database_open_beside(struct database *database)
{
    int version = 0;
    if (access(database->path, F_OK) != 0)
        return -errno;
    int code = open_handle(database, database->path, SQLITE_OPEN_READWRITE);
    if (code == SQLITE_OK)
        code = sqlite3_exec(database->handle, "PRAGMA synchronous = NORMAL", NULL, NULL, NULL);
    if (code == SQLITE_OK)
        code = read_version(database, &version);
    int error = database_fail(database, code, "cannot be opened");
    return error ? error : version > 0 && version <= database->format->version ? 0 : -ENOENT;
}

bool database_set_aside(struct database *database)
{
    static const char *const parts[] = { "", "-wal", "-shm" };
    char stamp[32];
    time_t now = time(NULL);
    struct tm tm;
    strftime(stamp, sizeof(stamp), "%Y%m%dT%H%M%SZ", gmtime_r(&now, &tm));
    int stem = (int)(strlen(database->path) - strlen(".sqlite"));
    bool moved = false;
    close_handle(database);
    for (size_t i = 0; i < sizeof(parts) / sizeof(parts[0]); i++) {
        char *from = mem_printf("%s%s", database->path, parts[i]);
        char *to = mem_printf("%.*s.damaged-%s.sqlite%s", stem, database->path, stamp, parts[i]);
        bool good = rename(from, to) == 0;
        if (i == 0) {
            moved = good;
            if (good)
                log_err(database->log, "%s: the database is damaged; renamed it to %s and started a new database", database->path, to);
            else
                log_err(database->log, "%s: the database is damaged and cannot be renamed: %s", database->path, strerror(errno));
        }
        mem_free(from);
        mem_free(to);
    }
    return moved;
}
