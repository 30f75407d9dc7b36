/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An SQLite file in a format of ours: opened, brought to this program's version, set aside where it is damaged; its statements are
   prepared once. Thread: one at a time per database. Functions that return int return 0 or -errno, already logged, unless they say that
   they return a code of SQLite. -EBADMSG: the file is damaged; -ENOSPC: the disk is full; -EROFS: it cannot be written. */
#ifndef BASE_FILES_DATABASE_H
#define BASE_FILES_DATABASE_H
#include <sqlite3.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log/log.h"

struct database_format { /* static */
    int application_id, version;
    const char *set_up;            /* pragmas of whoever writes it */
    const char *const *schemas;    /* `version` of them: each leads from the version before */
    const char *const *statements; /* statement_count of them */
    size_t statement_count;
};

struct database {
    struct log *log;
    const struct database_format *format;
    char *path;
    sqlite3 *handle; /* NULL: not open */
    sqlite3_stmt **statements;
};

/* Takes path (mem_free), which ends in ".sqlite". Opens nothing. */
void database_init(struct database *database, struct log *log, char *path, const struct database_format *format);
void database_finish(struct database *database); /* what is zero is fine; leaves it zero */

/* Opens the file to write, makes it where it is missing, and converts one of an older version in one transaction. A damaged one is set
   aside, and a new one begun: *renewed. One of a newer version is left alone: -EACCES. */
int database_open(struct database *database, bool *renewed);
/* Opens the file to read, on a disk that cannot be written too. Returns -ENOENT, without a line in the log, where there is no file or
   nothing has been written to it yet. The version is any up to this program's. */
int database_open_to_read(struct database *database);
/* Opens a file that another handle writes, to write to it as well: it is not made, converted or set aside, and what is committed may be
   lost with power, but is never half there. Returns -ENOENT, without a line in the log, where there is none of this version. */
int database_open_beside(struct database *database);
/* Closes the file and renames NAME.sqlite, with what SQLite keeps beside it, to NAME.damaged-INSTANT.sqlite: out of the way, for whoever
   wants to look into it. Returns false where it cannot be renamed. Logged either way. */
bool database_set_aside(struct database *database);

/* Returns a statement of the format, ready to bind and step; it stays the database's. NULL, which may be bound to and stepped: it cannot
   be prepared. */
sqlite3_stmt *database_statement(struct database *database, int index);
/* Steps once. Returns SQLite's code. */
int database_step(struct database *database, sqlite3_stmt *statement);
/* Steps to the end and resets. Returns SQLite's code, SQLITE_OK for SQLITE_DONE. */
int database_run(struct database *database, sqlite3_stmt *statement);
int database_exec(struct database *database, const char *sql, const char *doing);
/* Logs a code of SQLite, with the file, what was being done and the cause. Returns it as -errno; SQLITE_OK, _ROW and _DONE are 0. */
int database_fail(struct database *database, int code, const char *doing);

void database_bind_text(sqlite3_stmt *statement, int index, const char *text);    /* text outlives the step */
void database_bind_value(sqlite3_stmt *statement, int index, double value);       /* NaN is NULL */
double database_value(sqlite3_stmt *statement, int column);                       /* NULL is NaN */
const char *database_text(sqlite3_stmt *statement, int column);                   /* NULL is ""; until the next step */

#endif
