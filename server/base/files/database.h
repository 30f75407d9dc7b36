/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An SQLite file in one of our formats: opens it, upgrades it to this program's version, renames it if it is damaged, and
   prepares its statements once. Call from one thread at a time per database. Functions that return int return 0 or -errno,
   already logged, unless they are said to return an SQLite code. -EBADMSG: the file is damaged; -ENOSPC: the disk is full;
   -EROFS: the file cannot be written. */
#ifndef BASE_FILES_DATABASE_H
#define BASE_FILES_DATABASE_H
#include <errno.h>
#include <sqlite3.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log/log.h"

#define DATABASE_NEWER EPROTONOSUPPORT /* errno for a file that a newer version of this program wrote */

struct database_format { /* one of our file formats: SQLite's application id and version, the schema, and the prepared statements */
    int application_id, version;
    const char *set_up;            /* SQL pragmas for connections that write to the file */
    const char *const *schemas;    /* array of `version` SQL scripts; each upgrades a file from the preceding version */
    const char *const *statements; /* array of statement_count SQL texts, prepared on first use */
    size_t statement_count;
};

struct database {
    struct log *log;
    const struct database_format *format;
    char *path;
    sqlite3 *handle; /* connection; NULL: not open */
    sqlite3_stmt **statements;
};

/* Initialises a database without opening it. Takes ownership of `path` (mem_free), which must end in ".sqlite". */
void database_init(struct database *database, struct log *log, char *path, const struct database_format *format);
void database_finish(struct database *database); /* Closes the database; a zeroed struct is allowed and stays zeroed. */

/* Opens the file for writing. Creates it if it is missing, and upgrades an older version in one transaction. A damaged file is
   renamed and replaced by a new one; *renewed is then true. A file of a newer version is left unchanged: -DATABASE_NEWER. */
int database_open(struct database *database, bool *renewed);
/* Returns the text for an error of this module, for the log (static, or valid until strerror() is called again). */
const char *database_error_text(int error);
/* Opens the file for reading, even on a read-only disk. Returns -ENOENT, not logged, if the file is missing or still empty. The
   file may have any version up to this program's. */
int database_open_to_read(struct database *database);
/* Opens a file that another handle of this program already writes, so that both can write. Does not create, upgrade or rename
   the file. Commits are atomic, but the newest may be lost in a power failure. Returns -ENOENT, not logged, if the file is
   missing or has a newer version. */
int database_open_beside(struct database *database);
/* Closes the file and renames NAME.sqlite and SQLite's companion files to NAME.damaged-TIME.sqlite, for later analysis. Returns
   false if it cannot be renamed. Logs either result. */
bool database_set_aside(struct database *database);

/* Returns prepared statement number `index` of the file's format (struct database_format), reset and ready to bind and step;
   owned by the database. Returns NULL if the statement cannot be prepared; the functions that bind and step accept NULL. */
sqlite3_stmt *database_statement(struct database *database, int index);
/* Executes a statement up to its next row of results (sqlite3_step). Returns the SQLite code. */
int database_step(struct database *database, sqlite3_stmt *statement);
/* Steps a statement to its end and resets it. Returns the SQLite code, but SQLITE_OK for SQLITE_DONE. */
int database_run(struct database *database, sqlite3_stmt *statement);
int database_exec(struct database *database, const char *sql, const char *doing);
/* Logs an SQLite error with the file, the failed action (`doing`) and the cause. Returns the error as -errno, or 0 for
   SQLITE_OK, SQLITE_ROW and SQLITE_DONE. */
int database_fail(struct database *database, int code, const char *doing);

/* Binds a text to a parameter of the statement. The text must stay unchanged until the statement has been stepped. */
void database_bind_text(sqlite3_stmt *statement, int index, const char *text);
/* Binds a number to a parameter of the statement; NaN is bound as NULL. */
void database_bind_value(sqlite3_stmt *statement, int index, double value);
/* Returns the number in a column of the current row; NaN for NULL. */
double database_value(sqlite3_stmt *statement, int column);
/* Returns the text in a column of the current row, valid until the next step; "" for NULL. */
const char *database_text(sqlite3_stmt *statement, int column);

#endif
