/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Opening SQLite files of formats that Plantcast defines: current and other versions, damaged files, and errors. */
#include "tests/support/test.h"

#include <errno.h>
#include <unistd.h>

#include "base/files/database.h"
#include "base/text/text.h"

enum { ADD, ALL, WRONG, STATEMENTS };
static const char *const schemas[] = { "CREATE TABLE a(v REAL, s TEXT)", "CREATE TABLE b(x INTEGER); INSERT INTO b VALUES(7)" };
static const char *const sql[STATEMENTS] = {
    [ADD] = "INSERT INTO a VALUES(?, ?)",
    [ALL] = "SELECT v, s FROM a",
    [WRONG] = "SELECT 1 FROM none",
};
static const struct database_format first = { 99, 1, "", schemas, sql, STATEMENTS }, second = { 99, 2, "", schemas, sql, STATEMENTS };

struct database_setup {
    struct log *log;
    char *folder;
};

static void begin(struct database_setup *s)
{
    s->log = test_log();
    s->folder = temp_folder();
}

TEST_FIXTURE(struct database_setup, begin, NULL)

#define CASE(name) TEST_ON(struct database_setup *s, name, set_up, tear_down)

static struct database make(struct database_setup *s, const struct database_format *format)
{
    struct database db;
    database_init(&db, s->log, mem_printf("%s/x.sqlite", s->folder), format);
    return db;
}

static void write_once(struct database_setup *s, const struct database_format *format)
{
    struct database db = make(s, format);
    bool renewed;
    assert_int_equal(database_open(&db, &renewed), 0);
    assert_false(renewed);
    sqlite3_stmt *add = database_statement(&db, ADD);
    database_bind_value(add, 1, NAN);
    database_bind_text(add, 2, "x");
    assert_int_equal(database_run(&db, add), SQLITE_OK);
    database_finish(&db);
}

static int version_read(struct database_setup *s, const struct database_format *format)
{
    struct database db = make(s, format);
    int error = database_open_to_read(&db);
    database_finish(&db);
    return error;
}

CASE(what_is_written_is_read)
{
    assert_int_equal(version_read(s, &first), -ENOENT);
    write_once(s, &first);
    struct database db = make(s, &second);
    assert_int_equal(database_open_to_read(&db), 0);
    sqlite3_stmt *all = database_statement(&db, ALL);
    assert_int_equal(database_step(&db, all), SQLITE_ROW);
    assert_true(isnan(database_value(all, 0)));
    assert_string_equal(database_text(all, 1), "x");
    assert_int_equal(database_step(&db, all), SQLITE_DONE);
    database_finish(&db);
}

CASE(an_older_version_is_converted_and_a_newer_one_left_alone)
{
    bool renewed;
    write_once(s, &first);
    write_once(s, &second);
    struct database db = make(s, &second);
    assert_int_equal(database_open(&db, &renewed), 0);
    assert_int_equal(database_exec(&db, "UPDATE b SET x = 8", "cannot"), 0);
    database_finish(&db);
    db = make(s, &first);
    assert_int_equal(database_open(&db, &renewed), -DATABASE_NEWER);
    assert_false(renewed);
    database_finish(&db);
    assert_int_equal(version_read(s, &first), -DATABASE_NEWER);
}

CASE(a_file_without_anything_in_it_is_none)
{
    temp_write(s->folder, "x.sqlite", "", 0);
    assert_int_equal(version_read(s, &first), -ENOENT);
}

CASE(a_damaged_file_is_set_aside)
{
    char rubbish[4096];
    memset(rubbish, 'z', sizeof(rubbish));
    temp_write(s->folder, "x.sqlite", rubbish, sizeof(rubbish));
    assert_int_equal(version_read(s, &first), -EBADMSG);
    struct database db = make(s, &first);
    bool renewed;
    assert_int_equal(database_open(&db, &renewed), 0);
    assert_true(renewed);
    database_finish(&db);
    char *look = test_printf("test -e '%s'/x.damaged-*.sqlite", s->folder);
    assert_int_equal(system(look), 0);
}

/* A statement with an SQL error accepts bindings like any other; stepping it returns the error. */
CASE(a_wrong_statement_is_an_error_when_it_is_stepped)
{
    write_once(s, &first);
    struct database db = make(s, &first);
    assert_int_equal(database_open_to_read(&db), 0);
    sqlite3_stmt *wrong = database_statement(&db, WRONG);
    assert_null(wrong);
    sqlite3_bind_int64(wrong, 1, 5);
    database_bind_text(wrong, 2, "y");
    assert_int_equal(database_fail(&db, database_step(&db, wrong), "cannot be read"), -EIO);
    assert_int_equal(database_fail(&db, database_run(&db, database_statement(&db, ADD)), "cannot be written"), -EROFS);
    database_finish(&db);
}
