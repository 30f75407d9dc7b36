/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and deletes points in the table `outbox` of a month's file, which has the points still to be sent to PostgreSQL. */
#include "history/month_outbox.h"

#include <errno.h>

#include "base/files/database.h"
#include "base/mem.h"
#include "history/month.h"
#include "history/month_file.h"

/* maximum number of outbox rows deleted per transaction; limited because the transaction blocks the historian's writes */
enum { DELETE_ROWS = 20000 };
enum statement { BEGIN, COMMIT, THERE, SPAN, ROWS, HELD, TAGS, EVENTS, DELETE, STATEMENT_COUNT };

static const char *const sql[STATEMENT_COUNT] = {
    [BEGIN] = "BEGIN",
    [COMMIT] = "COMMIT",
    [THERE] = "SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = 'outbox'",
    [SPAN] = "SELECT (SELECT min(seq) FROM outbox), (SELECT max(seq) FROM outbox)",
    [ROWS] = "SELECT seq, tag, t, v, q FROM outbox ORDER BY seq LIMIT ?",
    [HELD] = "SELECT 0, tag, t, v, q FROM held",
    /* the name of a series that was set aside has a suffix, which is removed here: in PostgreSQL, name and unit together identify a tag */
    [TAGS] = "SELECT id, substr(name, 1, instr(name || char(31), char(31)) - 1), unit, step FROM tag",
    [EVENTS] = "SELECT t, kind, text FROM event",
    [DELETE] = "DELETE FROM outbox WHERE seq <= ?",
};
static const struct database_format format = { .version = HISTORY_VERSION, .statements = sql, .statement_count = STATEMENT_COUNT };

struct month_outbox {
    struct database db;
};

static int run_statement(struct month_outbox *outbox, enum statement which, const char *doing)
{
    return database_fail(&outbox->db, database_run(&outbox->db, database_statement(&outbox->db, which)), doing);
}

static int is_there(struct month_outbox *outbox)
{
    sqlite3_stmt *there = database_statement(&outbox->db, THERE);
    int code = database_step(&outbox->db, there);
    sqlite3_reset(there);
    return code == SQLITE_DONE ? -ENOENT : database_fail(&outbox->db, code, "cannot be read");
}

struct month_outbox *month_outbox_open(struct log *log, const char *folder, int month, int *error)
{
    struct month_outbox *outbox = mem_new(sizeof(*outbox));
    char name[MONTH_NAME_BYTES];
    month_name(month, name);
    database_init(&outbox->db, log, mem_printf("%s/%s", folder, name), &format);
    *error = database_open_beside(&outbox->db);
    if (!*error)
        *error = is_there(outbox);
    if (*error)
        month_outbox_close(&outbox);
    return outbox;
}

void month_outbox_close(struct month_outbox **outbox)
{
    if (!*outbox)
        return;
    database_finish(&(*outbox)->db);
    mem_free(*outbox);
    *outbox = NULL;
}

static int find_span(struct month_outbox *outbox, int64_t *first, int64_t *last)
{
    sqlite3_stmt *span = database_statement(&outbox->db, SPAN);
    int code = database_step(&outbox->db, span);
    bool any = code == SQLITE_ROW && sqlite3_column_type(span, 0) != SQLITE_NULL;
    *first = any ? sqlite3_column_int64(span, 0) : 1;
    *last = any ? sqlite3_column_int64(span, 1) : 0;
    sqlite3_reset(span);
    return database_fail(&outbox->db, code, "cannot be read");
}

int month_outbox_count(struct month_outbox *outbox, int64_t *count)
{
    int64_t first, last;
    int error = find_span(outbox, &first, &last);
    *count = last - first + 1;
    return error;
}

int month_outbox_last(struct month_outbox *outbox, int64_t *seq)
{
    int64_t first;
    int error = find_span(outbox, &first, seq);
    return error;
}

/* --- reading ------------------------------------------------------------------------------------------------------------------ */

typedef void take_row(struct month_outbox_batch *batch, sqlite3_stmt *row);

static struct month_outbox_row point_of(sqlite3_stmt *row)
{
    return (struct month_outbox_row){ sqlite3_column_int64(row, 0),
                                      sqlite3_column_int64(row, 1),
                                      { sqlite3_column_int64(row, 2), database_value(row, 3), (uint32_t)sqlite3_column_int64(row, 4) } };
}

static void take_point(struct month_outbox_batch *batch, sqlite3_stmt *row)
{
    mem_grow(&batch->rows, &batch->row_capacity, batch->row_count + 1, sizeof(*batch->rows));
    batch->rows[batch->row_count++] = point_of(row);
}

static void take_held(struct month_outbox_batch *batch, sqlite3_stmt *row)
{
    mem_grow(&batch->held, &batch->held_capacity, batch->held_count + 1, sizeof(*batch->held));
    batch->held[batch->held_count++] = point_of(row);
}

static void take_tag(struct month_outbox_batch *batch, sqlite3_stmt *row)
{
    mem_grow(&batch->tags, &batch->tag_capacity, batch->tag_count + 1, sizeof(*batch->tags));
    batch->tags[batch->tag_count++] = (struct month_outbox_tag){ sqlite3_column_int64(row, 0), mem_strdup(database_text(row, 1)),
                                                                 mem_strdup(database_text(row, 2)), sqlite3_column_int(row, 3) != 0 };
}

static void take_event(struct month_outbox_batch *batch, sqlite3_stmt *row)
{
    mem_grow(&batch->events, &batch->event_capacity, batch->event_count + 1, sizeof(*batch->events));
    batch->events[batch->event_count++] =
        (struct month_outbox_event){ sqlite3_column_int64(row, 0), mem_strdup(database_text(row, 1)), mem_strdup(database_text(row, 2)) };
}

static int take_all(struct month_outbox *outbox, enum statement which, size_t most, take_row *take, struct month_outbox_batch *batch)
{
    sqlite3_stmt *rows = database_statement(&outbox->db, which);
    int code;
    if (which == ROWS)
        sqlite3_bind_int64(rows, 1, (int64_t)most);
    while ((code = database_step(&outbox->db, rows)) == SQLITE_ROW)
        take(batch, rows);
    sqlite3_reset(rows);
    return database_fail(&outbox->db, code, "cannot be read");
}

int month_outbox_read(struct month_outbox *outbox, size_t most, struct month_outbox_batch *batch)
{
    month_outbox_batch_finish(batch);
    int error = run_statement(outbox, BEGIN, "cannot be read");
    if (error)
        return error;
    error = take_all(outbox, ROWS, most, take_point, batch);
    if (!error)
        error = take_all(outbox, HELD, 0, take_held, batch);
    if (!error)
        error = take_all(outbox, TAGS, 0, take_tag, batch);
    if (!error)
        error = take_all(outbox, EVENTS, 0, take_event, batch);
    int ended = run_statement(outbox, COMMIT, "cannot be read");
    return error ? error : ended;
}

void month_outbox_batch_finish(struct month_outbox_batch *batch)
{
    for (size_t i = 0; i < batch->tag_count; i++) {
        mem_free(batch->tags[i].name);
        mem_free(batch->tags[i].unit);
    }
    for (size_t i = 0; i < batch->event_count; i++) {
        mem_free(batch->events[i].kind);
        mem_free(batch->events[i].text);
    }
    mem_free(batch->rows);
    mem_free(batch->held);
    mem_free(batch->tags);
    mem_free(batch->events);
    *batch = (struct month_outbox_batch){ 0 };
}

/* --- deleting ----------------------------------------------------------------------------------------------------------------- */

int month_outbox_delete(struct month_outbox *outbox, int64_t seq)
{
    sqlite3_stmt *delete = database_statement(&outbox->db, DELETE);
    sqlite3_bind_int64(delete, 1, seq);
    return database_fail(&outbox->db, database_run(&outbox->db, delete),
                         "cannot delete points that were sent to PostgreSQL from the table `outbox`");
}

int month_outbox_shorten(struct month_outbox *outbox, int64_t keep)
{
    int64_t first, last;
    int error = find_span(outbox, &first, &last);
    for (int64_t to = first - 1; !error && to < last - keep;) {
        to = to + DELETE_ROWS < last - keep ? to + DELETE_ROWS : last - keep;
        error = month_outbox_delete(outbox, to);
    }
    return error;
}
